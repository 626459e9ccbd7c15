#include "errors.hpp"

#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nanobind/stl/string.h>

#include "stator/base/event.hpp"
#include "stator/bench/bench.hpp"
#include "stator/rack/file/rack_file_error.hpp"

namespace nb = nanobind;

namespace stator::python {

namespace {

std::string_view name_of(master::ErrorCode code) {
  using master::ErrorCode;
  switch (code) {
    case ErrorCode::port:
      return "port";
    case ErrorCode::timeout:
      return "timeout";
    case ErrorCode::working_counter:
      return "working-counter";
    case ErrorCode::no_slaves:
      return "no-slaves";
    case ErrorCode::sii:
      return "sii";
    case ErrorCode::state_refused:
      return "state-refused";
    case ErrorCode::state_timeout:
      return "state-timeout";
    case ErrorCode::mailbox:
      return "mailbox";
    case ErrorCode::sdo_aborted:
      return "sdo-aborted";
    case ErrorCode::protocol:
      return "protocol";
    case ErrorCode::configuration:
      return "configuration";
    case ErrorCode::drive_fault:
      return "drive-fault";
    case ErrorCode::drive_timeout:
      return "drive-timeout";
    case ErrorCode::argument:
      return "argument";
  }
  return "protocol";
}

/// Sets the exception `name` of stator._errors, made of `arguments`.
template <typename... Arguments>
void set_error(const char* name, Arguments&&... arguments) {
  const nb::object type = nb::module_::import_("stator._errors").attr(name);
  const nb::object error = type(std::forward<Arguments>(arguments)...);
  PyErr_SetObject(type.ptr(), error.ptr());
}

void translate(const std::exception_ptr& thrown, void* /*payload*/) {
  try {
    std::rethrow_exception(thrown);
  } catch (const nb::builtin_exception&) {
    throw;
  } catch (const MasterFailure& failure) {
    const std::string_view code = name_of(failure.error().code);
    set_error("MasterError", failure.what(), nb::str(code.data(), code.size()),
              failure.error().detail);
  } catch (const ObjectRefusal& refused) {
    set_error("ObjectRefused", refused.what(), static_cast<std::uint32_t>(refused.code()));
  } catch (const rack::RackFileError& error) {
    const settings::Problem& problem = error.problem();
    set_error("RackFileError", error.what(), problem.file(), problem.line());
  } catch (const RackFileMistakes& mistakes) {
    set_error("RackFileError", mistakes.what(), mistakes.first().file(), mistakes.first().line());
  } catch (const bench::TimeLimitReached& reached) {
    set_error("TimeLimitReached", fmt::format("the rack's limit of {:g} s of simulated time is "
                                              "reached; give it a larger one, limit=SECONDS",
                                              reached.limit.seconds())
                                      .c_str());
  } catch (const std::runtime_error& error) {
    set_error("Error", error.what());
  }
}

std::string text_of(const std::vector<settings::Problem>& mistakes) {
  std::string text;
  for (const settings::Problem& mistake : mistakes) {
    text += (text.empty() ? "" : "\n") + mistake.text();
  }
  return text;
}

}  // namespace

RackFileMistakes::RackFileMistakes(const std::vector<settings::Problem>& mistakes)
    : std::runtime_error(text_of(mistakes)), first_(mistakes.front()) {}

ObjectRefusal refusal(const dictionary::Refusal& refused) {
  if (refused.rule == nullptr) {
    return {
        fmt::format("refused with abort code {:08X}h", static_cast<std::uint32_t>(refused.code)),
        refused.code};
  }
  return {base::to_sentence({.time = {}, .rule = refused.rule, .arguments = refused.arguments}),
          refused.code};
}

void bind_errors() {
  nb::register_exception_translator(translate);
}

}  // namespace stator::python

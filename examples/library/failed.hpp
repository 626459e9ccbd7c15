#pragma once

#include <cstdio>

/// Says why a step failed; true if it did.
template <typename Result>
bool failed(const Result& result) {
  if (!result) {
    std::fprintf(stderr, "%s\n", result.error().text.c_str());
  }
  return !result;
}

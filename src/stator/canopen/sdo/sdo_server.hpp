// The SDO server of a CANopen node (CiA 301 §7.2.4): its settings, counters and transfers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/expected.hpp"
#include "stator/can/transmitter.hpp"
#include "stator/canopen/service.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/dictionary/quirks.hpp"
#include "stator/dictionary/write_completion.hpp"

namespace stator::canopen {

struct SdoServerConfiguration {
  /// How long the client may take between two frames of a transfer; afterwards 05040000h.
  base::SimDuration timeout{1'000'000'000};
  /// Without it every block request is refused with 05040001h.
  bool block_transfer = true;
  /// A block upload of a value no longer than the client's protocol switch threshold is answered by
  /// an expedited or segmented one, as the standard allows and some clients do not understand.
  bool honour_protocol_switch_threshold = false;
  /// Segments per block the server asks for in a block download, 1 to 127.
  std::uint8_t block_size = 127;
  /// Longest text or domain in bytes a client may write, where the dictionary has one to write.
  std::size_t longest_download = 16'384;
  /// What it does otherwise than a server should.
  dictionary::Quirks quirks{};
};

struct SdoServerStatistics {
  std::uint64_t requests = 0;   ///< frames taken, those of transfers included
  std::uint64_t malformed = 0;  ///< frames ignored because of their length
  std::uint64_t aborts = 0;     ///< transfers the server aborted
};

/// One SDO server (CiA 301 §7.2.4): expedited, segmented and block transfer in both directions. One
/// transfer at a time; a new initiate request supersedes one that the client abandoned.
///
/// Texts are uploaded from where the dictionary has them, so a long one costs nothing per segment
/// beyond the seven bytes moved. If it changes its length meanwhile, the transfer is aborted.
class SdoServer final : public Service {
 public:
  /// The server whose parameters are the object `parameter_index`, 1200h to 127Fh. The first one
  /// works also without that object, with the identifiers of the predefined connection set.
  SdoServer(dictionary::Dictionary& dictionary, std::uint16_t parameter_index,
            can::Transmitter& transmitter, base::EventReporter reporter,
            const SdoServerConfiguration& configuration);

  /// To be called before start(): the first server's identifiers contain the node-ID.
  void set_node_id(std::uint8_t node_id) { node_id_ = node_id; }
  /// Decides when a write is complete; null: at once.
  void set_write_completion(dictionary::WriteCompletion* completion) { completion_ = completion; }

  void start(base::SimTime now) override;
  void on_state(NmtState state, base::SimTime now) override;
  bool receive(const can::Frame& frame, base::SimTime now) override;
  void advance(base::SimTime now) override;
  [[nodiscard]] base::SimTime next_deadline() const override;

  [[nodiscard]] const SdoServerStatistics& statistics() const { return statistics_; }

 private:
  using Refusal = dictionary::Refusal;
  using Request = std::span<const std::byte, can::kMaximumData>;
  using Reply = std::array<std::byte, can::kMaximumData>;
  /// What is sent, nothing, or why the transfer is aborted.
  using Answer = base::Expected<std::optional<Reply>, Refusal>;

  enum class Transfer : std::uint8_t {
    none,
    segmented_upload,
    segmented_download,
    block_upload_begin,  ///< the client has to start the first block
    block_upload,        ///< segments go out, then the client acknowledges
    block_upload_end,    ///< the client has to confirm the end
    block_download,      ///< segments come in
    block_download_end,  ///< the client has to send the end with its checksum
    completing_write,    ///< carried out, not to be answered yet
  };

  struct Multiplexer {
    std::uint16_t index = 0;
    std::uint8_t subindex = 0;
  };

  /// State of a block transfer.
  struct Block {
    bool with_crc = false;
    std::uint8_t size = 0;         ///< segments per block
    std::uint8_t sequence = 0;     ///< of the last segment sent, or taken in order
    bool last = false;             ///< that segment was the value's last
    std::size_t first_offset = 0;  ///< where the block being sent began
    bool pending = false;          ///< segments have come that are not acknowledged
    /// What the client is told at the end of the block instead of an acknowledgement.
    std::optional<Refusal> refusal{};
  };

  [[nodiscard]] std::uint32_t channel(std::uint8_t subindex) const;
  [[nodiscard]] bool valid() const;
  [[nodiscard]] bool length_fits(const can::Frame& frame) const;
  void conclude(const Answer& answer, base::SimTime now);

  // Requests; sdo_server.cpp.
  [[nodiscard]] Answer dispatch(Request request, base::SimTime now);
  [[nodiscard]] Answer initiate_upload();
  [[nodiscard]] Answer answer_upload();
  [[nodiscard]] Answer upload_segment(unsigned command);
  [[nodiscard]] Answer initiate_download(Request request, base::SimTime now);
  [[nodiscard]] Answer download_segment(Request request, base::SimTime now);
  [[nodiscard]] dictionary::Verdict check_toggle(unsigned command) const;
  [[nodiscard]] Answer refuse_segments() const;
  [[nodiscard]] unsigned toggle_of_answer(unsigned command) const;
  void answer(const Reply& reply, base::SimTime now);

  // Block transfer; sdo_server_block.cpp.
  [[nodiscard]] Answer block_upload(Request request, unsigned subcommand, base::SimTime now);
  [[nodiscard]] Answer initiate_block_upload(Request request);
  [[nodiscard]] Answer block_upload_acknowledged(Request request, base::SimTime now);
  [[nodiscard]] dictionary::Verdict set_block_size(unsigned size);
  [[nodiscard]] Answer send_block(base::SimTime now);
  [[nodiscard]] bool block_sent() const;
  [[nodiscard]] Answer block_download(Request request, unsigned subcommand, base::SimTime now);
  [[nodiscard]] Answer initiate_block_download(Request request);
  [[nodiscard]] Answer block_download_segment(Request request);
  [[nodiscard]] Answer finish_block();
  [[nodiscard]] Answer end_block_download(Request request, base::SimTime now);

  // Values.
  [[nodiscard]] dictionary::Verdict open_upload();
  [[nodiscard]] std::span<const std::byte> upload_data() const;
  [[nodiscard]] dictionary::Verdict check_unchanged() const;
  [[nodiscard]] dictionary::Verdict open_download(std::optional<std::size_t> announced);
  [[nodiscard]] dictionary::Verdict check_room(std::size_t size) const;
  [[nodiscard]] Answer complete_download(const Reply& reply, base::SimTime now);
  [[nodiscard]] Answer write(std::span<const std::byte> data, const Reply& reply,
                             base::SimTime now);
  [[nodiscard]] Answer answer_when_complete(base::SimTime now);

  [[nodiscard]] Reply reply_to_initiate(unsigned command, std::uint32_t data = 0) const;
  [[nodiscard]] base::Unexpected<Refusal> refuse(dictionary::AbortCode code,
                                                 const base::EventRule& rule,
                                                 base::EventArgument third = {},
                                                 base::EventArgument fourth = {}) const;
  void forget();
  void send(const Reply& reply);
  void send_held(base::SimTime now);
  void abort(const Refusal& refusal, base::SimTime now);

  dictionary::Dictionary& dictionary_;
  std::uint16_t parameter_index_;
  can::Transmitter& transmitter_;
  base::EventReporter reporter_;
  SdoServerConfiguration configuration_;
  dictionary::WriteCompletion* completion_ = nullptr;
  std::uint8_t node_id_ = 0;
  /// Sub-indices 1 and 2 of the parameter object; null where it is not declared.
  std::array<const dictionary::Entry*, 2> parameters_{};
  dictionary::AccessContext context_;
  bool enabled_ = false;  ///< the NMT state allows SDOs
  SdoServerStatistics statistics_;

  unsigned command_ = 0;  ///< of the request being dealt with
  /// What a slow device has not answered yet; until then it looks at no other request.
  std::optional<Reply> held_{};
  base::SimTime held_until_ = base::SimTime::never();

  Transfer transfer_ = Transfer::none;
  Multiplexer multiplexer_;  ///< of the transfer, or of the request being dealt with
  dictionary::Entry* entry_ = nullptr;
  std::optional<std::size_t> size_;  ///< bytes of the value, as far as announced
  std::size_t offset_ = 0;           ///< bytes moved so far
  bool toggle_ = false;              ///< toggle bit the next segment must have
  Block block_;
  Reply completion_reply_{};  ///< what answers the write that is being completed
  base::SimTime deadline_ = base::SimTime::never();  ///< for the client's next frame
  base::SimTime retry_ = base::SimTime::never();     ///< for the server's own next attempt
  std::array<std::byte, 8> number_{};                ///< the value of an upload that is no text
  std::size_t longest_download_;
  std::vector<std::byte> buffer_;  ///< the value of a download
};

}  // namespace stator::canopen

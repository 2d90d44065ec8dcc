// SPDX-License-Identifier: BSD-3-Clause
// The reports of a real device, through hidapi (0.13) over the kernel's hidraw.
//
// What is easily got wrong with hidraw, and what this class does:
// - hid_read_timeout() gives 0 both when nothing came in time and for an empty packet. So it is
//   asked once more, without waiting, before read() says `nothing`.
// - hid_read_timeout() gives −1 when a signal interrupts it (EINTR), and when the device is
//   unplugged. hidapi hears of an unplug from poll() by POLLHUP, which hidraw sets for no other
//   reason and for which there is no errno; from read() by EIO; from any call by ENODEV. After
//   EINTR the call is tried again, kTries times in all; after that it counts as an error that may
//   pass. An unplug is final.
// - hid_write() waits in the kernel until the device has taken the report, up to 5 s. The thread
//   that waits can do nothing about that.
// - Opening, and asking for a feature report, can take as long. A thread of their own does both and
//   owns the device jointly. An answer that comes too late is dropped, and the device is closed
//   then.
// - hidraw keeps the oldest 63 reports, so that the reports that are read after a pause are old.
//   The loop has to notice that, by the device's time.
#pragma once

#include <atomic>
#include <memory>

#include "haptic/transport/hid.h"
#include "haptic/transport/transport.h"

namespace palpate {

inline constexpr Duration kAnswerTime = std::chrono::seconds(2);

/// @throws BackendError the device cannot be opened, or not in time; the message says what to do.
[[nodiscard]] std::shared_ptr<HidDevice> open_hid_device(const std::shared_ptr<Hid>& hid,
                                                         const std::string& path,
                                                         Duration deadline = kAnswerTime);

/// @throws BackendError the device does not answer, or not in time.
[[nodiscard]] Report get_feature_report(const std::shared_ptr<HidDevice>& device,
                                        std::uint8_t number, Duration deadline = kAnswerTime);

class HidTransport final : public Transport {
 public:
  /// How often a call that is interrupted is tried.
  static constexpr int kTries = 3;

  /// @param guardian The guardian of the device; nullptr: it has none.
  /// @param why_unguarded Why it has none, in words, where that is worth telling.
  explicit HidTransport(std::shared_ptr<HidDevice> device,
                        std::unique_ptr<Guardian> guardian = nullptr,
                        std::string why_unguarded = {})
      : device_(std::move(device)),
        guardian_(std::move(guardian)),
        why_unguarded_(std::move(why_unguarded)) {}

  TransportStatus read(Report& report, Duration timeout) noexcept override;
  /// Writes a report, unless it is empty.
  TransportStatus write(const Report& report) noexcept override;
  GuardianChannel* guardian() noexcept override {
    return guardian_ ? &guardian_->channel() : nullptr;
  }
  void host_lives() noexcept override {
    if (guardian_) guardian_->host_lives();
  }
  /// Says what was last wrong, as Transport::problem() does. It may be called from any thread.
  std::string problem() const override;

 private:
  std::shared_ptr<HidDevice> device_;
  /// The guardian, which must end before the device is closed.
  std::unique_ptr<Guardian> guardian_;
  std::string why_unguarded_;
  /// The last error of reading and of writing, an errno.
  std::atomic<int> read_error_{0};
  std::atomic<int> write_error_{0};
};

}  // namespace palpate

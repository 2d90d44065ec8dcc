// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/communicator.h"

#include <exception>
#include <string>

#include "base/error.h"

namespace palpate {
namespace {

class SerialCommunicator final : public Communicator {
 public:
  [[nodiscard]] int rank() const override { return 0; }
  [[nodiscard]] int size() const override { return 1; }
  [[nodiscard]] std::vector<Bytes> all_gather(const Bytes& mine) override { return {mine}; }
  [[nodiscard]] std::vector<Bytes> gather(const Bytes& mine) override { return {mine}; }
  [[nodiscard]] std::vector<Bytes> exchange(const std::vector<Bytes>& to) override { return to; }
  [[nodiscard]] std::unique_ptr<Communicator> split(int /*colour*/) override {
    return make_serial_communicator();
  }
  [[nodiscard]] Network& network() override { return *network_; }

 private:
  std::unique_ptr<Network> network_ = make_serial_network();
};

/// The kind of an error that was caught, then its message.
constexpr char kInput = 'i';
constexpr char kBackend = 'b';

Bytes to_bytes(const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

}  // namespace

std::unique_ptr<Communicator> make_serial_communicator() {
  return std::make_unique<SerialCommunicator>();
}

bool any(Communicator& communicator, bool mine) {
  const auto all = communicator.all_gather(to_bytes(mine ? "yes" : ""));
  for (const Bytes& one : all) {
    if (!one.empty()) return true;
  }
  return false;
}

void agree(Communicator& communicator, const std::function<void()>& body) {
  std::string error;
  try {
    body();
  } catch (const InputError& e) {
    error = kInput + std::string(e.what());
  } catch (const std::bad_alloc&) {
    error = kBackend + std::string("Out of memory.");
  } catch (const std::exception& e) {
    error = kBackend + std::string(e.what());
  }
  for (const Bytes& bytes : communicator.all_gather(to_bytes(error))) {
    if (bytes.empty()) continue;
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.front() == kInput) throw InputError(text.substr(1));
    throw BackendError(text.substr(1));
  }
}

}  // namespace palpate

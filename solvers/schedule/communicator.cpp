// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/communicator.h"

#include <cstdio>
#include <exception>
#include <string>

#include "base/error.h"
#include "base/memory_error.h"
#include "threads/thread_team.h"

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
  void share(Failure& failure) override {
    if (failure.kind != Failure::Kind::none) ++num_failures_;
  }
  [[nodiscard]] int num_shared_failures() const override { return num_failures_; }
  [[nodiscard]] Network& network() override { return *network_; }

 private:
  std::unique_ptr<Network> network_ = make_serial_network();
  int num_failures_ = 0;
};

void set(Failure& failure, Failure::Kind kind, const char* text) {
  failure.kind = kind;
  std::snprintf(failure.text, sizeof failure.text, "%s", text);
}

/// Describes the exception that is being handled.
void describe_current(Failure& failure) {
  try {
    throw;
  } catch (const InputError& error) {
    set(failure, Failure::Kind::input, error.what());
  } catch (const MemoryError& error) {
    set(failure, Failure::Kind::memory, error.what());
  } catch (const std::bad_alloc&) {
    char text[kMemoryTextBytes];
    describe_memory(nullptr, text);
    set(failure, Failure::Kind::memory, text);
  } catch (const std::exception& error) {
    set(failure, Failure::Kind::backend, error.what());
  } catch (...) {
    set(failure, Failure::Kind::backend, "Unknown error.");
  }
}

Bytes to_bytes(const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

}  // namespace

int Communicator::num_cores() { return num_usable_cores(); }

std::unique_ptr<Communicator> make_serial_communicator() {
  return std::make_unique<SerialCommunicator>();
}

int num_threads(Communicator& communicator, int asked) {
  return asked == 0 ? automatic_threads(communicator.num_cores()) : asked;
}

bool any(Communicator& communicator, bool mine) {
  const auto all = communicator.all_gather(to_bytes(mine ? "yes" : ""));
  for (const Bytes& one : all) {
    if (!one.empty()) return true;
  }
  return false;
}

void agree(Communicator& communicator, const std::function<void()>& body) {
  const int before = communicator.num_shared_failures();
  Failure failure;
  try {
    body();
  } catch (...) {
    if (communicator.num_shared_failures() > before) throw;  // it was thrown on every rank already
    describe_current(failure);
  }
  communicator.share(failure);
  switch (failure.kind) {
    case Failure::Kind::none: return;
    case Failure::Kind::input: throw InputError(failure.text);
    case Failure::Kind::memory: throw MemoryError(failure.text);
    case Failure::Kind::backend: throw BackendError(failure.text);
  }
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/mpi_network.h"

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <new>
#include <thread>
#include <unordered_map>
#include <utility>

#include "schedule/mpi_check.h"

namespace palpate {
namespace {

/// A message is sent in parts of this size, since counts in MPI are ints.
constexpr std::size_t kPartBytes = 16 << 20;

/// Memory that is freed when none is left for a message, so that the ranks can still tell each
/// other to end.
constexpr std::size_t kReserveBytes = 2 * kPartBytes;

/// rest() yields this often, and sleeps afterwards.
constexpr int kYields = 50;
constexpr double kShortestSleep = 10e-6;  // s
constexpr double kLongestSleep = 1e-3;    // s

class MpiNetwork final : public Network {
 public:
  explicit MpiNetwork(MPI_Comm comm) {
    check(MPI_Comm_dup(comm, &comm_), "MPI_Comm_dup");
    MPI_Comm_rank(comm_, &rank_);
    MPI_Comm_size(comm_, &size_);
    if (size_ > 1) reserve_.reset(new (std::nothrow) std::byte[kReserveBytes]);
  }

  ~MpiNetwork() override { MPI_Comm_free(&comm_); }

  MpiNetwork(const MpiNetwork&) = delete;
  MpiNetwork& operator=(const MpiNetwork&) = delete;

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }

  void send(int to, int tag, Bytes content) override {
    forget_sent();
    const std::size_t num_parts = content.size() / kPartBytes + 1;
    std::shared_ptr<const Bytes> kept;
    with_reserve([&] {
      reserve_more(requests_, num_parts);
      reserve_more(sent_, num_parts);
      kept = std::make_shared<const Bytes>(std::move(content));
    });
    std::size_t at = 0;
    do {
      const std::size_t count = std::min(kPartBytes, kept->size() - at);
      const bool last = at + count == kept->size();
      MPI_Request request = MPI_REQUEST_NULL;
      check(MPI_Isend(kept->data() + at, static_cast<int>(count), MPI_BYTE, to,
                      2 * tag + (last ? 1 : 0), comm_, &request),
            "MPI_Isend");
      requests_.push_back(request);
      sent_.push_back(kept);
      at += count;
    } while (at < kept->size());
  }

  [[nodiscard]] std::optional<Message> receive() override {
    forget_sent();
    start_receiving();
    // Find the first part that has arrived and has no earlier part of the same sender before it.
    for (auto i = incoming_.begin(); i != incoming_.end();) {
      const bool is_first = std::none_of(
          incoming_.begin(), i, [&](const Part& before) { return before.from == i->from; });
      int is_there = 0;
      if (is_first) check(MPI_Test(&i->request, &is_there, MPI_STATUS_IGNORE), "MPI_Test");
      if (is_there == 0) {
        ++i;
        continue;
      }
      std::optional<Message> message = add(std::move(*i));
      i = incoming_.erase(i);
      if (!message) continue;
      num_rests_ = 0;
      return message;
    }
    return std::nullopt;
  }

  void flush() override {
    check(MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE),
          "MPI_Waitall");
    requests_.clear();
    sent_.clear();
  }

  [[nodiscard]] double now() const override {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  void rest(double until) override {
    if (++num_rests_ <= kYields) {
      std::this_thread::yield();
      return;
    }
    const int doublings = std::min(num_rests_ - kYields, 20);
    const double sleep =
        std::min({kLongestSleep, kShortestSleep * (1 << doublings), until - now()});
    if (sleep > 0) std::this_thread::sleep_for(std::chrono::duration<double>(sleep));
  }

 private:
  struct Part {
    int from = 0;
    int tag = 0;
    bool last = false;
    Bytes content;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  /// Frees parts that were sent.
  void forget_sent() {
    if (requests_.empty()) return;
    int num_done = 0;
    done_.resize(requests_.size());
    check(MPI_Testsome(static_cast<int>(requests_.size()), requests_.data(), &num_done,
                       done_.data(), MPI_STATUSES_IGNORE),
          "MPI_Testsome");
    if (num_done <= 0) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < requests_.size(); ++i) {
      if (requests_[i] == MPI_REQUEST_NULL) continue;
      requests_[kept] = requests_[i];
      sent_[kept] = std::move(sent_[i]);
      ++kept;
    }
    requests_.resize(kept);
    sent_.resize(kept);
  }

  void start_receiving() {
    for (;;) {
      int has_come = 0;
      MPI_Status status;
      check(MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, comm_, &has_come, &status), "MPI_Iprobe");
      if (has_come == 0) return;
      int count = 0;
      MPI_Get_count(&status, MPI_BYTE, &count);
      // Allocate first: a part for which there is no memory stays in MPI.
      Part part;
      with_reserve([&] {
        part.content.resize(static_cast<std::size_t>(count));
        incoming_.emplace_back();
      });
      part.from = status.MPI_SOURCE;
      part.tag = status.MPI_TAG / 2;
      part.last = status.MPI_TAG % 2 == 1;
      check(MPI_Irecv(part.content.data(), count, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG,
                      comm_, &part.request),
            "MPI_Irecv");
      incoming_.back() = std::move(part);
    }
  }

  /// Calls f. If memory is short, frees the reserve and calls f again.
  template <class F>
  void with_reserve(F&& f) {
    try {
      f();
    } catch (const std::bad_alloc&) {
      if (reserve_ == nullptr) throw;
      reserve_.reset();
      f();
    }
  }

  /// Doubles the capacity if it is too small, as push_back() does.
  template <class T>
  static void reserve_more(std::vector<T>& list, std::size_t count) {
    if (list.size() + count > list.capacity()) list.reserve(2 * (list.size() + count));
  }

  /// Returns the message of which this part is the last one.
  std::optional<Message> add(Part&& part) {
    const auto partial = partial_.find(part.from);
    if (partial == partial_.end()) {
      if (part.last) return Message{part.from, part.tag, std::move(part.content)};
      partial_.emplace(part.from, std::move(part.content));
      return std::nullopt;
    }
    with_reserve([&] {
      partial->second.insert(partial->second.end(), part.content.begin(), part.content.end());
    });
    if (!part.last) return std::nullopt;
    Message message{part.from, part.tag, std::move(partial->second)};
    partial_.erase(partial);
    return message;
  }

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0;
  int size_ = 1;
  /// The requests of parts that are being sent, and the messages that they belong to.
  std::vector<MPI_Request> requests_;
  std::vector<std::shared_ptr<const Bytes>> sent_;
  std::vector<int> done_;
  /// Parts in the order of their arrival.
  std::deque<Part> incoming_;
  /// Messages of which only the first parts are here, by sender.
  std::unordered_map<int, Bytes> partial_;
  /// The memory is never written to, so that it takes address space alone. Null: there is no other
  /// rank, or no memory was left.
  std::unique_ptr<std::byte[]> reserve_;
  /// Calls of rest() since a message came.
  int num_rests_ = 0;
};

}  // namespace

std::unique_ptr<Network> make_mpi_network(const void* mpi_comm) {
  return std::make_unique<MpiNetwork>(*static_cast<const MPI_Comm*>(mpi_comm));
}

}  // namespace palpate

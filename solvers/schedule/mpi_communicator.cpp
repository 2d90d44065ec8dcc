// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/mpi_communicator.h"

#include <mpi.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "schedule/mpi_check.h"
#include "schedule/mpi_network.h"
#include "threads/usable_cores.h"

namespace palpate {
namespace {

/// Counts in MPI are ints; in units of eight bytes they reach 16 GiB.
constexpr std::int64_t kUnit = 8;

class MpiCommunicator final : public Communicator {
 public:
  explicit MpiCommunicator(MPI_Comm comm) {
    check(MPI_Comm_dup(comm, &comm_), "MPI_Comm_dup");
    MPI_Comm_rank(comm_, &rank_);
    MPI_Comm_size(comm_, &size_);
    network_ = make_mpi_network(&comm_);
  }

  ~MpiCommunicator() override { MPI_Comm_free(&comm_); }

  MpiCommunicator(const MpiCommunicator&) = delete;
  MpiCommunicator& operator=(const MpiCommunicator&) = delete;

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }

  [[nodiscard]] std::vector<Bytes> all_gather(const Bytes& mine) override {
    return gather(mine, true);
  }

  [[nodiscard]] std::vector<Bytes> gather(const Bytes& mine) override {
    return gather(mine, false);
  }

  [[nodiscard]] std::vector<Bytes> exchange(const std::vector<Bytes>& to) override {
    std::vector<std::int64_t> sent_bytes, received_bytes, sent, received;
    Layout from_here;
    agree(*this, [&] {
      for (const Bytes& message : to) {
        sent_bytes.push_back(static_cast<std::int64_t>(message.size()));
      }
      received_bytes.resize(to.size());
      from_here = lay_out(sent_bytes);
      sent.resize(from_here.total);
    });
    for (std::size_t r = 0; r < to.size(); ++r) {
      if (to[r].empty()) continue;
      std::memcpy(sent.data() + from_here.offsets[r], to[r].data(), to[r].size());
    }
    check(MPI_Alltoall(sent_bytes.data(), 1, MPI_INT64_T, received_bytes.data(), 1, MPI_INT64_T,
                       comm_),
          "MPI_Alltoall");
    Layout to_here;
    std::vector<Bytes> all;
    agree(*this, [&] {
      to_here = lay_out(std::move(received_bytes));
      received.resize(to_here.total);
      all = make_room(to_here);
    });
    check(MPI_Alltoallv(sent.data(), from_here.counts.data(), from_here.offsets.data(), MPI_INT64_T,
                        received.data(), to_here.counts.data(), to_here.offsets.data(), MPI_INT64_T,
                        comm_),
          "MPI_Alltoallv");
    take_apart(to_here, received, all);
    return all;
  }

  [[nodiscard]] std::unique_ptr<Communicator> split(int colour) override {
    agree(*this, [] {});
    MPI_Comm part = MPI_COMM_NULL;
    check(MPI_Comm_split(comm_, colour, rank_, &part), "MPI_Comm_split");
    auto communicator = std::make_unique<MpiCommunicator>(part);
    MPI_Comm_free(&part);
    return communicator;
  }

  void share(Failure& failure) override {
    const int mine = failure.kind != Failure::Kind::none ? rank_ : size_;
    int lowest = size_;
    check(MPI_Allreduce(&mine, &lowest, 1, MPI_INT, MPI_MIN, comm_), "MPI_Allreduce");
    if (lowest == size_) return;
    static_assert(std::is_trivially_copyable_v<Failure>);
    check(MPI_Bcast(&failure, sizeof failure, MPI_BYTE, lowest, comm_), "MPI_Bcast");
    ++num_failures_;
  }
  [[nodiscard]] int num_shared_failures() const override { return num_failures_; }

  [[nodiscard]] const void* mpi_comm() const override { return &comm_; }

  [[nodiscard]] int num_cores() override {
    MPI_Comm same_machine = MPI_COMM_NULL;
    check(MPI_Comm_split_type(comm_, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &same_machine),
          "MPI_Comm_split_type");
    MpiCommunicator neighbours(same_machine);
    MPI_Comm_free(&same_machine);
    const std::vector<char> own = usable_cores();
    const auto* first = reinterpret_cast<const std::byte*>(own.data());
    std::vector<std::vector<char>> all;
    for (const Bytes& cores : neighbours.all_gather({first, first + own.size()})) {
      const auto* begin = reinterpret_cast<const char*>(cores.data());
      all.emplace_back(begin, begin + cores.size());
    }
    return share_of_cores(all, static_cast<std::size_t>(neighbours.rank()));
  }

  [[nodiscard]] Network& network() override { return *network_; }

 private:
  /// Positions of the messages of all ranks in one buffer.
  struct Layout {
    std::vector<std::int64_t> bytes;
    /// Lengths and positions in units.
    std::vector<int> counts;
    std::vector<int> offsets;
    std::int64_t total = 0;
  };

  /// The layout of messages of these sizes.
  [[nodiscard]] static Layout lay_out(std::vector<std::int64_t> sizes) {
    Layout layout{std::move(sizes), {}, {}, 0};
    for (const std::int64_t bytes : layout.bytes) {
      const std::int64_t units = (bytes + kUnit - 1) / kUnit;
      if (layout.total + units > std::numeric_limits<int>::max()) {
        throw BackendError(
            "The ranks would exchange more than 16 GiB at once. Explore fewer active "
            "nodes in one run or use a coarser mesh.");
      }
      layout.counts.push_back(static_cast<int>(units));
      layout.offsets.push_back(static_cast<int>(layout.total));
      layout.total += units;
    }
    return layout;
  }

  static std::vector<std::int64_t> to_units(const Bytes& message) {
    std::vector<std::int64_t> units((message.size() + kUnit - 1) / kUnit);
    if (!message.empty()) std::memcpy(units.data(), message.data(), message.size());
    return units;
  }

  static std::vector<Bytes> make_room(const Layout& layout) {
    std::vector<Bytes> all;
    for (const std::int64_t bytes : layout.bytes) all.emplace_back(bytes);
    return all;
  }

  static void take_apart(const Layout& layout, const std::vector<std::int64_t>& units,
                         std::vector<Bytes>& all) {
    for (std::size_t r = 0; r < all.size(); ++r) {
      if (all[r].empty()) continue;
      std::memcpy(all[r].data(), units.data() + layout.offsets[r], all[r].size());
    }
  }

  /// @returns The messages of all ranks, on rank 0 or on all.
  [[nodiscard]] std::vector<Bytes> gather(const Bytes& mine, bool is_for_all) {
    std::vector<std::int64_t> sent, sizes, received;
    agree(*this, [&] {
      sent = to_units(mine);
      sizes.resize(size_);
    });
    const auto my_bytes = static_cast<std::int64_t>(mine.size());
    check(MPI_Allgather(&my_bytes, 1, MPI_INT64_T, sizes.data(), 1, MPI_INT64_T, comm_),
          "MPI_Allgather");
    const bool receives = is_for_all || rank_ == 0;
    Layout layout;
    std::vector<Bytes> all;
    agree(*this, [&] {
      layout = lay_out(std::move(sizes));
      if (!receives) return;
      received.resize(layout.total);
      all = make_room(layout);
    });
    const int count = layout.counts[rank_];
    if (is_for_all) {
      check(MPI_Allgatherv(sent.data(), count, MPI_INT64_T, received.data(), layout.counts.data(),
                           layout.offsets.data(), MPI_INT64_T, comm_),
            "MPI_Allgatherv");
    } else {
      check(MPI_Gatherv(sent.data(), count, MPI_INT64_T, received.data(), layout.counts.data(),
                        layout.offsets.data(), MPI_INT64_T, 0, comm_),
            "MPI_Gatherv");
    }
    if (receives) take_apart(layout, received, all);
    return all;
  }

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0;
  int size_ = 1;
  int num_failures_ = 0;
  std::unique_ptr<Network> network_;
};

}  // namespace

std::unique_ptr<Communicator> make_mpi_communicator(const void* mpi_comm) {
  return std::make_unique<MpiCommunicator>(*static_cast<const MPI_Comm*>(mpi_comm));
}

}  // namespace palpate

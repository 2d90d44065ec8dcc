// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/mpi_communicator.h"

#include <mpi.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "schedule/mpi_check.h"
#include "schedule/mpi_network.h"

namespace palpate {
namespace {

/// Counts in MPI are ints; in units of eight bytes they reach to 16 GiB.
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
    const Layout layout = lay_out(mine);
    const std::vector<std::int64_t> sent = to_units(mine);
    std::vector<std::int64_t> received(layout.total);
    check(MPI_Allgatherv(sent.data(), layout.counts[rank_], MPI_INT64_T, received.data(),
                         layout.counts.data(), layout.offsets.data(), MPI_INT64_T, comm_),
          "MPI_Allgatherv");
    return take_apart(layout, received);
  }

  [[nodiscard]] std::vector<Bytes> gather(const Bytes& mine) override {
    const Layout layout = lay_out(mine);
    const std::vector<std::int64_t> sent = to_units(mine);
    std::vector<std::int64_t> received(rank_ == 0 ? layout.total : 0);
    check(MPI_Gatherv(sent.data(), layout.counts[rank_], MPI_INT64_T, received.data(),
                      layout.counts.data(), layout.offsets.data(), MPI_INT64_T, 0, comm_),
          "MPI_Gatherv");
    return rank_ == 0 ? take_apart(layout, received) : std::vector<Bytes>();
  }

  [[nodiscard]] std::vector<Bytes> exchange(const std::vector<Bytes>& to) override {
    std::vector<std::int64_t> sent_bytes;
    for (const Bytes& message : to) {
      sent_bytes.push_back(static_cast<std::int64_t>(message.size()));
    }
    std::vector<std::int64_t> received_bytes(to.size());
    check(MPI_Alltoall(sent_bytes.data(), 1, MPI_INT64_T, received_bytes.data(), 1, MPI_INT64_T,
                       comm_),
          "MPI_Alltoall");
    const Layout from_here = lay_out(std::move(sent_bytes));
    const Layout to_here = lay_out(std::move(received_bytes));
    std::vector<std::int64_t> sent(from_here.total);
    for (std::size_t r = 0; r < to.size(); ++r) {
      if (to[r].empty()) continue;
      std::memcpy(sent.data() + from_here.offsets[r], to[r].data(), to[r].size());
    }
    std::vector<std::int64_t> received(to_here.total);
    check(MPI_Alltoallv(sent.data(), from_here.counts.data(), from_here.offsets.data(), MPI_INT64_T,
                        received.data(), to_here.counts.data(), to_here.offsets.data(), MPI_INT64_T,
                        comm_),
          "MPI_Alltoallv");
    return take_apart(to_here, received);
  }

  [[nodiscard]] std::unique_ptr<Communicator> split(int colour) override {
    MPI_Comm part = MPI_COMM_NULL;
    check(MPI_Comm_split(comm_, colour, rank_, &part), "MPI_Comm_split");
    auto communicator = std::make_unique<MpiCommunicator>(part);
    MPI_Comm_free(&part);
    return communicator;
  }

  [[nodiscard]] const void* mpi_comm() const override { return &comm_; }

  [[nodiscard]] Network& network() override { return *network_; }

 private:
  /// Where the message of each rank lies among those of all.
  struct Layout {
    std::vector<std::int64_t> bytes;
    /// In units.
    std::vector<int> counts;
    std::vector<int> offsets;
    std::int64_t total = 0;
  };

  /// Of what each rank gives to all.
  [[nodiscard]] Layout lay_out(const Bytes& mine) const {
    const auto my_bytes = static_cast<std::int64_t>(mine.size());
    std::vector<std::int64_t> bytes(size_);
    check(MPI_Allgather(&my_bytes, 1, MPI_INT64_T, bytes.data(), 1, MPI_INT64_T, comm_),
          "MPI_Allgather");
    return lay_out(std::move(bytes));
  }

  /// Of messages of these sizes.
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

  static std::vector<Bytes> take_apart(const Layout& layout,
                                       const std::vector<std::int64_t>& units) {
    std::vector<Bytes> all;
    for (std::size_t r = 0; r < layout.bytes.size(); ++r) {
      const auto* first = reinterpret_cast<const std::byte*>(units.data() + layout.offsets[r]);
      all.emplace_back(first, first + layout.bytes[r]);
    }
    return all;
  }

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0;
  int size_ = 1;
  std::unique_ptr<Network> network_;
};

}  // namespace

std::unique_ptr<Communicator> make_mpi_communicator(const void* mpi_comm) {
  return std::make_unique<MpiCommunicator>(*static_cast<const MPI_Comm*>(mpi_comm));
}

}  // namespace palpate

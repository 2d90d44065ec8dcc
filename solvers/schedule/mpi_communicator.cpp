// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/mpi_communicator.h"

#include <mpi.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "base/error.h"

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
  }

  ~MpiCommunicator() override { MPI_Comm_free(&comm_); }

  MpiCommunicator(const MpiCommunicator&) = delete;
  MpiCommunicator& operator=(const MpiCommunicator&) = delete;

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }

  [[nodiscard]] std::vector<Bytes> all_gather(const Bytes& mine) override {
    const auto my_bytes = static_cast<std::int64_t>(mine.size());
    std::vector<std::int64_t> bytes(size_);
    check(MPI_Allgather(&my_bytes, 1, MPI_INT64_T, bytes.data(), 1, MPI_INT64_T, comm_),
          "MPI_Allgather");
    std::vector<int> counts(size_);
    std::vector<int> offsets(size_);
    std::int64_t total = 0;
    for (int r = 0; r < size_; ++r) {
      const std::int64_t units = (bytes[r] + kUnit - 1) / kUnit;
      if (total + units > std::numeric_limits<int>::max()) {
        throw BackendError("The ranks would exchange more than 16 GiB at once. Explore fewer active "
                           "nodes in one run or use a coarser mesh.");
      }
      counts[r] = static_cast<int>(units);
      offsets[r] = static_cast<int>(total);
      total += units;
    }
    std::vector<std::int64_t> sent(counts[rank_]);
    if (!mine.empty()) std::memcpy(sent.data(), mine.data(), mine.size());
    std::vector<std::int64_t> received(total);
    check(MPI_Allgatherv(sent.data(), counts[rank_], MPI_INT64_T, received.data(), counts.data(),
                         offsets.data(), MPI_INT64_T, comm_),
          "MPI_Allgatherv");
    std::vector<Bytes> all(size_);
    for (int r = 0; r < size_; ++r) {
      const auto* first = reinterpret_cast<const std::byte*>(received.data() + offsets[r]);
      all[r].assign(first, first + bytes[r]);
    }
    return all;
  }

 private:
  static void check(int status, const char* call) {
    if (status != MPI_SUCCESS) {
      throw BackendError(std::string(call) + " failed with code " + std::to_string(status) + '.');
    }
  }

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0;
  int size_ = 1;
};

}  // namespace

std::unique_ptr<Communicator> make_mpi_communicator(const void* mpi_comm) {
  return std::make_unique<MpiCommunicator>(*static_cast<const MPI_Comm*>(mpi_comm));
}

}  // namespace palpate

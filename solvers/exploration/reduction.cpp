// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/reduction.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>

#include "base/memory_error.h"
#include "exploration/transfer.h"

namespace palpate {
namespace {

/// A region of a rigid tool's space has no more states than these if it can be halved. With more
/// states, a basis has to serve more of the organ; with fewer, the bases take most of the file.
constexpr std::size_t kMostInRegion = 1024;
/// The side of the octree's root cells, in steps of the grid: they reach beyond any grid.
constexpr std::int32_t kRootSide = 1024;
static_assert(kRootSide > kLargestResolution / 2);

/// The snapshots of one batch of a region that one rank has.
struct Share {
  /// Columns of the snapshots in the batch.
  std::vector<Eigen::Index> places;
  Snapshots snapshots;
};
template <class Visit>
void for_each_part(Share& share, Visit&& visit) {
  visit(share.places);
  visit(share.snapshots);
}

/// Whether the snapshots can be put into a batch.
bool fit(const Share& share, const Snapshots& batch) {
  const auto count = static_cast<Eigen::Index>(share.places.size());
  const auto fits = [&](const auto& one, const auto& all, Eigen::Index columns) {
    return one.rows() == all.rows() && one.cols() == columns * count;
  };
  const Snapshots& own = share.snapshots;
  return fits(own.u, batch.u, 1) && fits(own.w, batch.w, 3) && fits(own.p, batch.p, 1) &&
         fits(own.p_w, batch.p_w, 3) &&
         std::all_of(share.places.begin(), share.places.end(),
                     [&](Eigen::Index place) { return place >= 0 && place < batch.u.cols(); });
}

CheckPointBox cell_at(const CheckPoint& first, std::int32_t side) {
  CheckPointBox cell{first, first};
  for (auto& x : cell.last) x += side - 1;
  return cell;
}

/// Divides a cell of the octree into regions.
void cut(const CheckPoint& first, std::int32_t side, std::vector<StateKey> keys,
         const std::vector<ReductionRegion>& there, std::vector<ReductionRegion>& regions) {
  if (keys.empty()) return;
  const CheckPointBox cell = cell_at(first, side);
  const auto has = [&](const ReductionRegion& region) { return cell.contains(region.box.first); };
  const auto is_in_box = [&](const ReductionRegion& region) {
    return region.box.contains(cell.first) && region.box.contains(cell.last);
  };
  if (std::any_of(there.begin(), there.end(), is_in_box)) return;
  const bool splits = std::any_of(there.begin(), there.end(), has) || keys.size() > kMostInRegion;
  if (!splits || side == 1) {
    regions.emplace_back().box = cell;
    return;
  }
  const std::int32_t half = side / 2;
  std::array<std::vector<StateKey>, 8> parts;
  for (const StateKey& key : keys) {
    std::size_t part = 0;
    for (int a = 0; a < 3; ++a) part = 2 * part + (key.check_point[a] >= first[a] + half ? 1 : 0);
    parts[part].push_back(key);
  }
  keys = {};
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const CheckPoint corner = {first[0] + (part & 4 ? half : 0), first[1] + (part & 2 ? half : 0),
                               first[2] + (part & 1 ? half : 0)};
    cut(corner, half, std::move(parts[part]), there, regions);
  }
}

/// Does a part of the work on every rank.
/// @note Collective
template <class Body>
void together(Communicator& communicator, Body&& body) {
  agree(communicator, [&] { with_memory("to reduce the displacements to modes", body); });
}

/// A state of a region, and the lowest rank that has it.
struct Placed {
  StateKey key;
  int rank = 0;
};

/// The states of each region, in order.
std::vector<std::vector<Placed>> place(const ReductionTask& task) {
  std::map<ToolSpaceKey, std::vector<std::size_t>> regions_of;
  for (std::size_t r = 0; r < task.regions.size(); ++r) {
    regions_of[task.regions[r].tool_space].push_back(r);
  }
  std::vector<std::vector<Placed>> placed(task.regions.size());
  for (const auto& [key, holder] : task.holders) {
    const std::vector<std::size_t>& there = regions_of[key.tool_space];
    const auto found = std::find_if(there.begin(), there.end(), [&, &key = key](std::size_t r) {
      return task.regions[r].box.contains(key.check_point);
    });
    if (found != there.end()) placed[*found].push_back({key, holder});
  }
  return placed;
}

/// The scale of the fields in each region.
/// @note Collective
std::vector<FieldScale> find_scales(const ReductionTask& task,
                                    const std::vector<std::vector<Placed>>& placed,
                                    Communicator& communicator) {
  std::vector<FieldScale> scales(task.regions.size());
  together(communicator, [&] {
    Snapshots one(static_cast<Eigen::Index>(task.points.size()), task.num_pressures, 1);
    for (std::size_t r = 0; r < scales.size(); ++r) {
      for (const Placed& state : placed[r]) {
        if (state.rank != communicator.rank()) continue;
        one.set(0, task.load(state.key), task.points, task.regions[r].step);
        scales[r].take(one);
      }
    }
  });
  Packer mine;
  mine.put_list(scales);
  for (const Bytes& bytes : communicator.all_gather(mine.take())) {
    const auto of_rank = Unpacker(bytes).take_list<std::vector<FieldScale>>();
    for (std::size_t r = 0; r < scales.size(); ++r) scales[r].take(of_rank[r]);
  }
  return scales;
}

/// Reduces one region on each rank, at most.
class Round {
 public:
  Round(const ReductionTask& task, const std::vector<std::vector<Placed>>& placed,
        const std::vector<FieldScale>& scales, const std::vector<std::size_t>& regions,
        Communicator& communicator)
      : task_(task),
        placed_(placed),
        scales_(scales),
        regions_(regions),
        communicator_(communicator),
        batch_(batch_size(num_points(), task.num_pressures)) {}

  /// @returns The region that this rank has reduced; nothing: it had no region.
  /// @note Collective
  std::optional<PackedReduction> run() {
    std::size_t longest = 0;
    for (const std::size_t r : regions_) longest = std::max(longest, placed_[r].size());
    for (std::size_t first = 0; first < longest; first += static_cast<std::size_t>(batch_)) {
      std::vector<Bytes> to(static_cast<std::size_t>(communicator_.size()));
      together(communicator_, [&] {
        for (std::size_t rank = 0; rank < regions_.size(); ++rank) to[rank] = packed(rank, first);
      });
      std::vector<Bytes> from = communicator_.exchange(to);
      to.clear();
      together(communicator_, [&] { take(std::move(from), first); });
    }
    std::optional<PackedReduction> packed;
    together(communicator_, [&] {
      if (!reducer_) return;
      Reduction reduction = reducer_->finish();
      reduction.basis.box = task_.regions[own_region()].box;
      reduction.basis.keep = task_.keep;
      packed = PackedReduction{pack(reduction.basis), std::move(reduction.fields)};
    });
    return packed;
  }

 private:
  [[nodiscard]] Eigen::Index num_points() const {
    return static_cast<Eigen::Index>(task_.points.size());
  }
  [[nodiscard]] std::size_t own_region() const {
    return regions_[static_cast<std::size_t>(communicator_.rank())];
  }
  [[nodiscard]] std::size_t end_of(const std::vector<Placed>& states, std::size_t first) const {
    return std::min(first + static_cast<std::size_t>(batch_), states.size());
  }

  /// The snapshots that this rank has of a batch of another rank's region. In the first batch, rank
  /// 0 adds the existing basis.
  [[nodiscard]] Bytes packed(std::size_t rank, std::size_t first) const {
    const ReductionRegion& region = task_.regions[regions_[rank]];
    const std::vector<Placed>& states = placed_[regions_[rank]];
    Packer message;
    if (first == 0) {
      message.put(region.begin != nullptr);
      if (region.begin != nullptr) message.put(*region.begin);
    }
    Share share;
    for (std::size_t s = first; s < end_of(states, first); ++s) {
      if (states[s].rank != communicator_.rank()) continue;
      share.places.push_back(static_cast<Eigen::Index>(s - first));
    }
    share.snapshots = Snapshots(num_points(), task_.num_pressures,
                                static_cast<Eigen::Index>(share.places.size()));
    for (std::size_t i = 0; i < share.places.size(); ++i) {
      const StateKey& key = states[first + static_cast<std::size_t>(share.places[i])].key;
      share.snapshots.set(static_cast<Eigen::Index>(i), task_.load(key), task_.points, region.step);
    }
    message.put(share);
    return message.take();
  }

  /// Adds a batch to this rank's region.
  void take(std::vector<Bytes> from, std::size_t first) {
    if (static_cast<std::size_t>(communicator_.rank()) >= regions_.size()) return;
    const std::vector<Placed>& states = placed_[own_region()];
    std::optional<FieldBasis> begin;
    const std::size_t count = first < states.size() ? end_of(states, first) - first : 0;
    Snapshots batch(num_points(), task_.num_pressures, static_cast<Eigen::Index>(count));
    for (Bytes& bytes : from) {
      Unpacker message(bytes);
      if (first == 0 && message.take<bool>()) begin = message.take<FieldBasis>();
      const auto share = message.take<Share>();
      Unpacker::require(fit(share, batch));
      for (std::size_t i = 0; i < share.places.size(); ++i) {
        batch.set(share.places[i], share.snapshots, static_cast<Eigen::Index>(i));
      }
      bytes = {};
    }
    if (first == 0) {
      reducer_ = std::make_unique<FieldReducer>(
          num_points(), task_.num_pressures, scales_[own_region()],
          task_.regions[own_region()].step, task_.bound, begin ? &*begin : nullptr);
    }
    if (count > 0) reducer_->add(batch);
  }

  const ReductionTask& task_;
  const std::vector<std::vector<Placed>>& placed_;
  const std::vector<FieldScale>& scales_;
  /// The region of each rank.
  const std::vector<std::size_t>& regions_;
  Communicator& communicator_;
  Eigen::Index batch_;
  std::unique_ptr<FieldReducer> reducer_;
};

}  // namespace

std::vector<ReductionRegion> plan_regions(const ToolSpaceSetup& setup,
                                          const std::vector<StateKey>& keys,
                                          const std::vector<ReductionRegion>& there) {
  std::vector<ReductionRegion> regions = there;
  if (!setup.presses()) {
    if (regions.empty()) {
      CheckPointBox& whole = regions.emplace_back().box;
      whole.first.fill(-kRootSide);
      whole.last.fill(kRootSide - 1);
    }
  } else {
    for (int root = 0; root < 8; ++root) {
      CheckPoint first;
      for (int a = 0; a < 3; ++a) first[a] = (root >> a & 1) != 0 ? 0 : -kRootSide;
      const CheckPointBox cell = cell_at(first, kRootSide);
      std::vector<StateKey> inside;
      std::copy_if(keys.begin(), keys.end(), std::back_inserter(inside),
                   [&](const StateKey& key) { return cell.contains(key.check_point); });
      cut(first, kRootSide, std::move(inside), there, regions);
    }
  }
  std::int64_t number = 0;
  for (const ReductionRegion& box : there) number = std::max(number, box.number + 1);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    regions[r].tool_space = setup.key();
    regions[r].step = setup.grid.field_step();
    if (r >= there.size()) regions[r].number = number++;
  }
  return regions;
}

StateHolders find_holders(const std::vector<StateKey>& own, Communicator& communicator) {
  Packer mine;
  mine.put_list(own);
  StateHolders holders;
  int rank = 0;
  for (const Bytes& bytes : communicator.all_gather(mine.take())) {
    for (const StateKey& key : Unpacker(bytes).take_list<std::vector<StateKey>>()) {
      holders.emplace(key, rank);
    }
    ++rank;
  }
  return holders;
}

void reduce_on_ranks(const ReductionTask& task, Communicator& communicator,
                     const TakeReduction& take) {
  const std::vector<std::vector<Placed>> placed = place(task);
  const std::vector<FieldScale> scales = find_scales(task, placed, communicator);
  std::vector<std::size_t> due;
  for (std::size_t r = 0; r < placed.size(); ++r) {
    if (!placed[r].empty()) due.push_back(r);
  }
  const auto num_ranks = static_cast<std::size_t>(communicator.size());
  for (std::size_t first = 0; first < due.size(); first += num_ranks) {
    const std::vector<std::size_t> regions(
        due.begin() + static_cast<std::ptrdiff_t>(first),
        due.begin() + static_cast<std::ptrdiff_t>(std::min(first + num_ranks, due.size())));
    std::optional<PackedReduction> reduction =
        Round(task, placed, scales, regions, communicator).run();
    Packer mine;
    if (reduction) mine.put(*reduction);
    reduction.reset();
    std::vector<Bytes> all = communicator.gather(mine.take());
    together(communicator, [&] {
      for (std::size_t i = 0; i < all.size() && i < regions.size(); ++i) {
        std::vector<StateKey> keys;
        for (const Placed& state : placed[regions[i]]) keys.push_back(state.key);
        take(task.regions[regions[i]], keys, Unpacker(all[i]).take<PackedReduction>());
        all[i] = {};
      }
    });
  }
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/kept_model.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>

#include "base/content_hash.h"
#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "reduced/model_arrays.h"

namespace palpate {
namespace {

/// The kinds of errors of measure_model(), then the same kinds for tools that were trained at
/// places.
constexpr std::array<const char*, 6> kErrorKinds = {"One tool at rest",
                                                    "All tools at rest",
                                                    "Motion",
                                                    "One tool at rest between places",
                                                    "All tools at rest between places",
                                                    "Motion between places"};
constexpr const char* kBetweenPlaces = " between places";
constexpr std::size_t kKindsOfModel = 3;
constexpr std::size_t kMotion = 2;

/// Calls visit for each number of an error, in the order of its columns.
template <class Error, class Visit>
void for_each_number(Error& row, Visit&& visit) {
  visit(row.error.mean);
  visit(row.error.rms);
  visit(row.error.max);
  visit(row.error.largest_force);
  visit(row.error.largest_trust);
  visit(row.error.num_compared);
  visit(row.error.num_failed);
  visit(row.median_step);
  visit(row.longest_step);
  visit(row.whole_step);
}
constexpr Eigen::Index kErrorColumns = 11;
const std::string kErrors = "Errors";

Eigen::MatrixXd matrix_of(const std::vector<MeasuredError>& errors) {
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(errors.size()), kErrorColumns);
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    const MeasuredError& error = errors[static_cast<std::size_t>(r)];
    const auto* const kind = std::find(kErrorKinds.begin(), kErrorKinds.end(), error.kind);
    Eigen::Index column = 0;
    matrix(r, column++) = static_cast<double>(kind - kErrorKinds.begin());
    for_each_number(error, [&](const auto& x) { matrix(r, column++) = static_cast<double>(x); });
  }
  return matrix;
}

std::vector<MeasuredError> errors_of(const Eigen::MatrixXd& matrix) {
  std::vector<MeasuredError> errors;
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    MeasuredError& error = errors.emplace_back();
    Eigen::Index column = 0;
    const auto last = static_cast<double>(kErrorKinds.size() - 1);
    const double kind = std::min(last, std::max(0.0, matrix(r, column++)));
    error.kind = kErrorKinds[static_cast<std::size_t>(kind)];
    for_each_number(
        error, [&](auto& x) { x = static_cast<std::decay_t<decltype(x)>>(matrix(r, column++)); });
  }
  return errors;
}

storage::Arrays arrays_of(const KeptModel& kept, const ReductionTools& tools) {
  storage::Arrays arrays = arrays_of(kept.model);
  arrays["Basis"] = kept.basis;
  if (kept.rest.size() > 0) arrays["Rest"] = kept.rest;
  const auto num_tools = static_cast<Eigen::Index>(tools.nodes.size());
  arrays["ActiveNodes"] =
      Eigen::Map<const Eigen::Matrix<Index, Eigen::Dynamic, 1>>(tools.nodes.data(), num_tools)
          .cast<double>();
  arrays["Fit"] = Eigen::RowVector2d(kept.residual, kept.within_tolerance ? 1 : 0);
  arrays[kErrors] = matrix_of(kept.errors);
  return arrays;
}

/// @throws InputError an array is missing or has another size, since another program wrote it.
KeptModel kept_model_of(const storage::Arrays& arrays, const Scene& scene) {
  KeptModel kept;
  kept.model = model_of(arrays);
  const auto find = [&](const std::string& name, Eigen::Index rows, Eigen::Index columns) {
    const auto found = arrays.find(name);
    if (found == arrays.end() || (rows >= 0 && found->second.rows() != rows) ||
        found->second.cols() != columns) {
      throw InputError("The reduced model is damaged: its array " + name +
                       " is missing or of another size. Build it again, with another file.");
    }
    // Errors are not numbers if nothing could be compared.
    if (name != kErrors && !found->second.allFinite()) {
      throw InputError("The reduced model is damaged: its array " + name +
                       " has a number that is not finite. Build it again, with another file.");
    }
    return found->second;
  };
  kept.basis =
      find("Basis", 3 * Eigen::Index{scene.body.mesh.num_points()}, kept.model.num_coordinates());
  if (kept.model.points.rest_gradients.size() > 0) kept.rest = find("Rest", kept.basis.rows(), 1);
  const Eigen::MatrixXd fit = find("Fit", 1, 2);
  kept.residual = fit(0, 0);
  kept.within_tolerance = fit(0, 1) != 0;
  kept.errors = errors_of(find(kErrors, -1, kErrorColumns));
  kept.was_there = true;
  return kept;
}

/// Whether the errors were measured on the number of paths that is asked for.
bool are_of(const MeasureOptions& measure, const KeptModel& kept) {
  const auto num_paths =
      std::count_if(kept.errors.begin(), kept.errors.end(), [](const MeasuredError& error) {
        return error.kind == kErrorKinds[kMotion] ||
               error.kind == kErrorKinds[kKindsOfModel + kMotion];
      });
  return !kept.model.has_inertia() || num_paths == measure.paths;
}

storage::Arrays arrays_of(const TrainedPlaces& trained) {
  storage::Arrays arrays = {
      {"PlaceModes", trained.modes},
      {"PlaceStates", trained.states},
      {"PlaceTools", trained.tools},
      {"PlaceReach", Eigen::RowVector2d(trained.reach, trained.num_left_out)}};
  if (trained.rest.size() > 0) arrays["PlaceRest"] = trained.rest;
  return arrays;
}

/// @throws InputError an array is missing or has another size, since another program wrote it.
TrainedPlaces trained_of(const storage::Arrays& arrays) {
  TrainedPlaces trained;
  const auto find = [&](const char* name) {
    const auto found = arrays.find(name);
    if (found != arrays.end()) return found->second;
    throw InputError(std::string("The training at places is damaged: its array ") + name +
                     " is missing. Build the model again, with another file.");
  };
  trained.modes = find("PlaceModes");
  trained.states = find("PlaceStates");
  trained.tools = find("PlaceTools");
  if (const auto rest = arrays.find("PlaceRest"); rest != arrays.end())
    trained.rest = rest->second.reshaped();
  const Eigen::MatrixXd reach = find("PlaceReach");
  if (reach.rows() != 1 || reach.cols() != 2) {
    throw InputError(
        "The training at places is damaged: its array PlaceReach has another size. Build the model "
        "again, with another file.");
  }
  trained.reach = reach(0, 0);
  trained.num_left_out = static_cast<int>(reach(0, 1));
  return trained;
}

/// A hash of the rheology of each cell, so that the order in which materials are listed does not
/// matter. The hash of a scene without a body force does not distinguish materials that differ in
/// their rheology alone.
std::string rheology_of_cells(const Scene& scene, const std::vector<Rheology>& rheologies) {
  ContentHash hash;
  for (const Index material : scene.body.material_of_cell) {
    hash.add(values_of(rheologies.at(static_cast<std::size_t>(material))));
  }
  return hash.text();
}

/// A text of everything on which a model, or a training, depends.
std::string text_of(const Scene& scene, const std::vector<Rheology>& rheologies,
                    const ReductionTools& tools, const ReductionOptions& options) {
  std::ostringstream text;
  text << std::hexfloat << hash(scene);
  const bool is_uniform = std::adjacent_find(rheologies.begin(), rheologies.end(),
                                             [](const Rheology& a, const Rheology& b) {
                                               return !(a == b);
                                             }) == rheologies.end();
  if (is_uniform) {
    for (const Rheology& rheology : rheologies) {
      for (const double x : values_of(rheology)) text << ' ' << x;
    }
  } else {
    text << " cells " << rheology_of_cells(scene, rheologies);
  }
  for (std::size_t t = 0; t < tools.patches.size(); ++t) {
    text << " tool " << tools.nodes[t];
    for (const Index point : tools.patches[t].points()) text << ' ' << point;
  }
  text << " options " << options.modes << ' ' << options.tolerance << ' ' << options.max_points
       << ' ' << options.training_paths << ' ' << options.seed << ' ' << options.reach << ' '
       << options.path_duration << ' ' << options.bandwidth << ' ' << options.taps << ' '
       << options.shortest_tap << ' ' << options.time_step << ' ' << options.all_tools_states << ' '
       << options.equilibrium.tolerance << ' ' << options.equilibrium.max_seconds << ' '
       << options.equilibrium.single_precision;
  if (!options.gravity.isZero(0)) text << " gravity " << options.gravity.transpose();
  return text.str();
}

std::string checksum(const std::string& text) {
  const XXH128_hash_t digest = XXH3_128bits(text.data(), text.size());
  std::ostringstream key;
  key << std::hex << digest.high64 << '-' << digest.low64;
  return key.str();
}

/// The body at rest under its loads, as a file of the scene needs it.
SettledBody find_rest(const Scene& scene, EquilibriumOptions options) {
  if (!scene.has_load()) return {};
  // This takes a few factorisations, so nobody needs to abort it.
  options.abort_requested = nullptr;
  const EquilibriumSolver solver(scene, options);
  require_rest(solver);
  return {solver.settled().u, solver.settled().p};
}

/// Whether the file has the result of the training at the places.
bool has_places(const std::filesystem::path& path, const Scene& scene,
                const std::vector<Rheology>& rheologies, const ReductionTools& tools,
                const ReductionOptions& options) {
  if (tools.places.empty() || !std::filesystem::exists(path)) return false;
  const std::string key = key_of_places(scene, rheologies, tools.places, options);
  return StateSpaceFile::open_read_only(path).reduced_models().read(key).has_value();
}

/// Builds a model of tools at their own places, from a training at other places.
/// @note Collective
BuiltModel build_of_places(const Scene& scene, const std::vector<Rheology>& rheologies,
                           const ReductionTools& tools, const ReductionOptions& options,
                           StateSpaceFile* file, Communicator& communicator, KeptPlaces& places,
                           bool& were_there) {
  BuiltModel built;
  agree(communicator, [&] {
    for (const std::vector<BondedPatch>& place : tools.places) {
      if (place.size() == tools.patches.size()) continue;
      throw InputError("A place of training has " + std::to_string(place.size()) + " tools, and " +
                       std::to_string(tools.patches.size()) +
                       " are to be attached. Give each place as many.");
    }
    were_there = keep_places(scene, rheologies, tools.places, options, file, communicator, places);
    built.aborted = places.trained.aborted;
    if (built.aborted || communicator.rank() != 0) return;
    if (options.report) options.report("Attaching the tools");
    Scene checked = scene;
    check(checked);
    built = PlacedTools(checked, rheologies, places.trained).attach(tools.patches, options);
  });
  return built;
}

}  // namespace

std::string key_of_model(const Scene& scene, const std::vector<Rheology>& rheologies,
                         const ReductionTools& tools, const ReductionOptions& options) {
  std::string text = text_of(scene, rheologies, tools, options);
  if (!tools.places.empty())
    text += " of " + key_of_places(scene, rheologies, tools.places, options);
  return checksum(text);
}

std::string key_of_places(const Scene& scene, const std::vector<Rheology>& rheologies,
                          const std::vector<std::vector<BondedPatch>>& places,
                          const ReductionOptions& options) {
  // Options of attaching tools do not count.
  ReductionOptions of_training = options;
  const ReductionOptions defaults;
  of_training.modes = defaults.modes;
  of_training.tolerance = defaults.tolerance;
  of_training.max_points = defaults.max_points;
  std::string text = text_of(scene, rheologies, {}, of_training);
  text += " place modes " + std::to_string(options.place_modes);
  for (const std::vector<BondedPatch>& place : places) {
    text += " place";
    for (const BondedPatch& tool : place) {
      text += " tool";
      for (const Index point : tool.points()) text += ' ' + std::to_string(point);
    }
  }
  return checksum(text);
}

bool keep_places(const Scene& scene, const std::vector<Rheology>& rheologies,
                 const std::vector<std::vector<BondedPatch>>& places,
                 const ReductionOptions& options, StateSpaceFile* file, Communicator& communicator,
                 KeptPlaces& kept) {
  bool were_there = false;
  agree(communicator, [&] {
    const bool is_first = communicator.rank() == 0;
    const std::string key = key_of_places(scene, rheologies, places, options);
    if (is_first && file != nullptr) {
      kept = {};
      if (const auto arrays = file->reduced_models().read(key)) kept = {key, trained_of(*arrays)};
    }
    were_there = any(communicator, is_first && kept.key == key);
    if (were_there) return;
    kept = {};
    kept.trained = train_places(scene, rheologies, places, options, {communicator, file, key});
    if (kept.trained.aborted) return;
    kept.key = key;
    if (is_first && file != nullptr) file->reduced_models().add(key, arrays_of(kept.trained));
  });
  return were_there;
}

KeptModel build_kept_model(const Scene& scene, const std::vector<Rheology>& rheologies,
                           const ReductionTools& tools, const ReductionOptions& options,
                           const MeasureOptions& measure, const std::filesystem::path& path,
                           Communicator& communicator, KeptPlaces* places) {
  KeptModel kept;
  agree(communicator, [&] {
    const bool is_first = communicator.rank() == 0;
    std::optional<StateSpaceFile> file;
    const std::string key = key_of_model(scene, rheologies, tools, options);
    if (is_first && !path.empty()) {
      check_reduction(scene, rheologies, options);
      const double tolerance = options.equilibrium.tolerance;
      const auto read = [&] {
        kept = {};
        if (const auto arrays = file->reduced_models().read(key))
          kept = kept_model_of(*arrays, scene);
      };
      if (std::filesystem::exists(path)) {
        file.emplace(StateSpaceFile::open_read_only(path));
        file->require(scene, tolerance);
        read();
      }
      if (!(kept.was_there && are_of(measure, kept))) {
        file.reset();
        std::string not_kept;
        try {
          const bool is_new = !std::filesystem::exists(path);
          file.emplace(StateSpaceFile::open_or_create(
              path, scene, tolerance,
              is_new ? find_rest(scene, options.equilibrium) : SettledBody()));
        } catch (const BackendError& error) {
          if (!kept.was_there && !has_places(path, scene, rheologies, tools, options)) throw;
          not_kept = error.what();
          file.emplace(StateSpaceFile::open_read_only(path));
        }
        read();
        kept.not_kept = not_kept;
      }
    }
    if (!any(communicator, kept.was_there)) {
      StateSpaceFile* const kept_in = file ? &*file : nullptr;
      KeptPlaces own;
      BuiltModel built =
          tools.places.empty()
              ? build_reduced_model(scene, rheologies, tools.patches, options,
                                    {communicator, kept_in, key})
              : build_of_places(scene, rheologies, tools, options, kept_in, communicator,
                                places == nullptr ? own : *places, kept.were_places_there);
      kept.aborted = built.aborted;
      kept.model = std::move(built.model);
      kept.basis = std::move(built.basis);
      kept.rest = std::move(built.rest);
      kept.residual = built.residual;
      kept.within_tolerance = built.within_tolerance;
    }
    if (!is_first) return;
    if (!kept.aborted && !(kept.was_there && are_of(measure, kept))) {
      const auto ends = [&] { return measure.abort_requested && measure.abort_requested(); };
      try {
        if (options.report) options.report("Errors");
        kept.errors = measure_model(scene, rheologies, tools.patches, options, kept.model, measure);
        if (!tools.places.empty()) {
          for (MeasuredError& row : kept.errors) row.kind += kBetweenPlaces;
        }
      } catch (const BackendError&) {
        // If an abort was asked for, the body may not reach the end of a path.
        if (!ends()) throw;
      }
      kept.aborted = ends();
      if (file && kept.not_kept.empty() && !kept.aborted) {
        file->reduced_models().add(key, arrays_of(kept, tools));
      }
    }
    if (!file) return;
    kept.damaged = file->left_out();
    file->close();
  });
  kept.aborted = any(communicator, kept.aborted);
  return kept;
}

}  // namespace palpate

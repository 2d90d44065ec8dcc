// SPDX-License-Identifier: BSD-3-Clause
#include "PalpateLooks.h"

#include "vtkSMProxyManager.h"
#include "vtkSMSettings.h"

namespace
{
/// The priority is below that of ParaView's site settings and of the user's.
constexpr double Priority = -1;

// Arrays whose values have names have names of their own that no array of other data is likely to
// have, because a colour map is found by the name alone.
//
// The front of the body in which a state space is drawn is culled (402). So nothing hides the
// check-points within from the eye and from a selection, and a touched body at the same place hides
// this one. Lines wider than 1 would be culled too.
constexpr const char* Looks = R"json({
  "representations": {
    "PalpateStateSpaceRepresentation": {
      "BlockSelectors": ["/Root/Surface", "/Root/Configurations"],
      "BlockOpacities": ["/Root/Surface", "0.5"],
      "BackfaceRepresentation": 402,
      "PointSize": 9,
      "RenderPointsAsSpheres": 1
    },
    "PalpateBodyRepresentation": { "NonlinearSubdivisionLevel": 0 },
    "PalpateMarksRepresentation": {
      "PointSize": 10,
      "RenderPointsAsSpheres": 1,
      "LineWidth": 4
    },
    "PalpateErrorChartRepresentation": {
      "SeriesMarkerStyle": ["Trilinear", "4", "Tricubic", "4", "RBF linear", "4",
        "RBF cubic", "4", "Energy Hermite", "4", "Energy Hermite, no third derivatives", "5",
        "Linear", "4"],
      "SeriesMarkerSize": ["Trilinear", "9", "Tricubic", "9", "RBF linear", "9",
        "RBF cubic", "9", "Energy Hermite", "9", "Energy Hermite, no third derivatives", "9",
        "Linear", "9"],
      "SeriesColor": ["Trilinear", "0.6", "0.6", "0.6", "Tricubic", "0.45", "0.34", "0.29",
        "RBF linear", "0.55", "0.75", "0.91", "RBF cubic", "0.12", "0.47", "0.71",
        "Energy Hermite", "0.84", "0.15", "0.16",
        "Energy Hermite, no third derivatives", "0.95", "0.6", "0.2",
        "Linear", "0", "0", "0"]
    },
    "PalpateMotionChartRepresentation": {
      "UseIndexForXAxis": 0,
      "XArrayName": "Time",
      "SeriesColor": ["KineticEnergy", "0.84", "0.15", "0.16", "ElasticEnergy", "0.12", "0.47",
        "0.71", "WeightEnergy", "0.6", "0.6", "0.6", "ViscousEnergy", "0.27", "0.62", "0.36",
        "Dissipated", "0.95", "0.6", "0.2", "Work", "0", "0", "0"]
    }
  },
  "standard_presets": {
    "EstimatedError": "Plasma (matplotlib)",
    "ErrorEnergyHermite": "Plasma (matplotlib)"
  },
  "array_lookup_tables": {
    "EstimatedError": { "PVLookupTable": { "NanColor": [0.6, 0.6, 0.6] } },
    "ErrorEnergyHermite": { "PVLookupTable": { "NanColor": [0.6, 0.6, 0.6] } },
    "SolveStatus": { "PVLookupTable": {
      "IndexedLookup": 1,
      "Annotations": ["0", "good", "1", "near a fold", "2", "beyond the force limit",
        "3", "unstable", "4", "inverted", "5", "not solved"],
      "IndexedColors": [0.27, 0.62, 0.36, 0.95, 0.83, 0.30, 0.36, 0.55, 0.83, 0.96, 0.58, 0.22,
        0.80, 0.20, 0.16, 0.25, 0.25, 0.25]
    } },
    "BoundaryKind": { "PVLookupTable": {
      "IndexedLookup": 1,
      "Annotations": ["0", "free", "1", "touchable", "2", "fixed", "3", "held", "4", "loaded"],
      "IndexedColors": [0.85, 0.85, 0.83, 0.55, 0.78, 0.60, 0.80, 0.20, 0.16, 0.96, 0.58, 0.22,
        0.36, 0.55, 0.83]
    } },
    "SurfaceFault": { "PVLookupTable": {
      "IndexedLookup": 1,
      "Annotations": ["0", "open edge", "1", "edge of more than two triangles",
        "2", "opposite normals", "3", "triangle without an area", "4", "crossing triangles"],
      "IndexedColors": [0.80, 0.20, 0.16, 0.58, 0.25, 0.65, 0.95, 0.83, 0.30, 0.25, 0.25, 0.25,
        0.96, 0.58, 0.22]
    } }
  }
})json";

/// Before 6, ParaView shows all series of a chart except those that are named with 0.
constexpr const char* HiddenSeries = R"json({
  "representations": {
    "PalpateErrorChartRepresentation": {
      "SeriesVisibility": ["Time", "0", "Bytes", "0", "PrecomputeSeconds", "0",
        "RBF linear, no polynomial", "0", "RBF linear, no intermediate states", "0",
        "RBF cubic, no polynomial", "0", "RBF cubic, no intermediate states", "0"]
    },
    "PalpateMotionChartRepresentation": {
      "SeriesVisibility": ["Time", "0", "StepLength", "0", "MinimumDetF", "0", "LocalError", "0",
        "Residual", "0", "Iterations", "0", "Halvings", "0", "Flags", "0", "Outcome", "0", "Trust", "0",
        "Tangents", "0", "StepSeconds", "0", "Position0_X", "0",
        "Position0_Y", "0", "Position0_Z", "0", "Position0_Magnitude", "0", "Force0_X", "0",
        "Force0_Y", "0", "Force0_Z", "0", "Force0_Magnitude", "0", "Position1_X", "0",
        "Position1_Y", "0", "Position1_Z", "0", "Position1_Magnitude", "0", "Force1_X", "0",
        "Force1_Y", "0", "Force1_Z", "0", "Force1_Magnitude", "0"]
    }
  }
})json";

/// From 6 on, ParaView shows only the series that are named with 1.
constexpr const char* ShownSeries = R"json({
  "representations": {
    "PalpateErrorChartRepresentation": {
      "SeriesVisibility": ["Energy Hermite", "1", "Energy Hermite, no third derivatives", "1",
        "Linear", "1", "RBF cubic", "1", "RBF linear", "1", "Tricubic", "1", "Trilinear", "1"]
    },
    "PalpateMotionChartRepresentation": {
      "SeriesVisibility": ["KineticEnergy", "1", "ElasticEnergy", "1", "WeightEnergy", "1",
        "ViscousEnergy", "1", "Dissipated", "1", "Work", "1"]
    }
  }
})json";
}

void PalpateAddLooks()
{
  vtkSMSettings* settings = vtkSMSettings::GetInstance();
  settings->AddCollectionFromString(Looks, Priority);
  settings->AddCollectionFromString(
    vtkSMProxyManager::GetVersionMajor() < 6 ? HiddenSeries : ShownSeries, Priority);
}

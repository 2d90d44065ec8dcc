// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/types.h"
#include "vtkType.h"

/// Ids of points as the solver's indices; palpate::BondedPatches checks the rest.
/// @param name The name of such a point in the error.
/// @throws palpate::InputError an id is no index.
inline std::vector<palpate::Index> vtkPalpateActiveNodes(
  const std::vector<vtkIdType>& ids, const std::string& name = "Active node")
{
  std::vector<palpate::Index> nodes;
  for (const vtkIdType id : ids)
  {
    if (id < 0 || id > std::numeric_limits<palpate::Index>::max())
    {
      throw palpate::InputError(name + " " + std::to_string(id) +
        " does not exist: the points of the body are counted from 0.");
    }
    nodes.push_back(static_cast<palpate::Index>(id));
  }
  return nodes;
}

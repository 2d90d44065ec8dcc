// SPDX-License-Identifier: BSD-3-Clause
// Each filter of ours works on one body, surface or state space. ParaView runs a filter that is
// given a collection of other data sets once for each of them, and aborts where it cannot collect
// the outputs. So the filters accept such a collection as a whole, and refuse it with an error.
#pragma once

#include <string>
#include <type_traits>

#include "base/error.h"
#include "vtkAlgorithm.h"
#include "vtkCompositeDataSet.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"

/// For FillInputPortInformation: makes the port take data of a type, and any collection as a whole.
inline void vtkPalpateTakeWhole(vtkInformation* port, const char* type)
{
  port->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), type);
  port->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
}

/// The input of a port that takes one data set, or one state space (a composite `Data`). As the
/// class of the input is the same on every rank, so is the error.
/// @throws palpate::InputError the input is another collection.
template <class Data>
Data* vtkPalpateInput(vtkInformationVector* port)
{
  vtkDataObject* input = vtkDataObject::GetData(port);
  auto* data = Data::SafeDownCast(input);
  if (!data && input)
  {
    const std::string name = input->GetClassName();
    if constexpr (std::is_base_of_v<vtkCompositeDataSet, Data>)
    {
      throw palpate::InputError("The input is no state space: it is a " + name +
        ". Use the output of Precompute State Space or of State Space Reader.");
    }
    throw palpate::InputError("The input is a collection of data sets, a " + name +
      ", but one data set is needed. Take one of them with Extract Block, or join them with Merge "
      "Blocks.");
  }
  return data;
}

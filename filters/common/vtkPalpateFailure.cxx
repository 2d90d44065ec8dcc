// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFailure.h"

#include <exception>

#include "base/memory_error.h"
#include "schedule/communicator.h"
#include "vtkCommunicator.h"
#include "vtkDataObject.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerKey.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpatePlainEnd.h"
#include "vtkStringArray.h"

namespace
{
/// The name of the mark, for whoever looks at the data.
constexpr const char* Name = "Error";

/// Made when the library is loaded: a process finds the key of data that it receives by its name.
vtkInformationIntegerKey* const Failed =
  new vtkInformationIntegerKey("FAILED", "vtkPalpateFailure");

vtkStringArray* FindMark(vtkDataObject* data)
{
  vtkFieldData* fields = data->GetFieldData();
  for (int i = 0; fields && i < fields->GetNumberOfArrays(); ++i)
  {
    auto* array = vtkStringArray::SafeDownCast(fields->GetAbstractArray(i));
    if (array && array->HasInformation() && array->GetInformation()->Has(Failed) &&
      array->GetNumberOfValues() > 0)
    {
      return array;
    }
  }
  return nullptr;
}

bool AnyRank(bool mine, vtkMultiProcessController* controller)
{
  const int sent = mine ? 1 : 0;
  int received = sent;
  if (controller && controller->GetNumberOfProcesses() > 1)
  {
    controller->AllReduce(&sent, &received, 1, vtkCommunicator::MAX_OP);
  }
  return received != 0;
}
}

void vtkPalpateMarkFailed(vtkDataObject* output, const char* message)
{
  output->Initialize();
  vtkNew<vtkStringArray> mark;
  mark->SetName(Name);
  mark->InsertNextValue(message);
  mark->GetInformation()->Set(Failed, 1);
  vtkNew<vtkFieldData> fieldData;
  fieldData->AddArray(mark);
  output->SetFieldData(fieldData);
}

std::string vtkPalpateFailureOf(vtkDataObject* data)
{
  vtkStringArray* mark = FindMark(data);
  return mark ? mark->GetValue(0) : std::string();
}

bool vtkPalpatePassFailure(vtkDataObject* input, vtkDataObject* output)
{
  vtkStringArray* mark = FindMark(input);
  if (!mark)
  {
    return false;
  }
  vtkPalpateMarkFailed(output, mark->GetValue(0).c_str());
  return true;
}

unsigned long vtkPalpateProduce(vtkObject* self, vtkDataObject* output,
  vtkMultiProcessController* controller, const std::function<void()>& body) noexcept
{
  const vtkPalpatePlainEnd plainEnd;
  unsigned long code = vtkErrorCode::NoError;
  std::exception_ptr error;
  vtkPalpateGuard(self,
    [&]
    {
      try
      {
        palpate::with_memory(nullptr, body);
      }
      catch (const std::exception& exception)
      {
        error = std::current_exception();
        // The ranks must agree even if there is not enough memory for a mark.
        vtkPalpateGuard(nullptr, [&] { vtkPalpateMarkFailed(output, exception.what()); });
      }
      catch (...)
      {
        error = std::current_exception();
        vtkPalpateMarkFailed(output, "Unknown error.");
      }
      const bool failed = error || FindMark(output);
      const bool isFirst = !controller || controller->GetLocalProcessId() == 0;
      const bool firstHasError = AnyRank(isFirst && error, controller);
      if (!AnyRank(failed, controller))
      {
        return;
      }
      code = vtkErrorCode::UserError;
      if (!failed)
      {
        vtkPalpateMarkFailed(output, "Another rank failed.");
      }
      if (error && (isFirst || !firstHasError))
      {
        std::rethrow_exception(error);
      }
    });
  return code;
}

unsigned long vtkPalpateProduce(vtkObject* self, vtkDataObject* output,
  vtkMultiProcessController* controller,
  const std::function<void(palpate::Communicator&)>& body) noexcept
{
  return vtkPalpateProduce(self, output, controller,
    [&]
    {
      const auto communicator = vtkPalpateCommunicator(controller);
      palpate::agree(*communicator, [&] { body(*communicator); });
    });
}

// SPDX-License-Identifier: BSD-3-Clause
// Lets an object of VTK throw an exception once, when it is next modified: a library for the tests
// in Python.
#include <stdexcept>

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkNew.h"
#include "vtkObject.h"

namespace {
void Throw(vtkObject* object, unsigned long, void* observer, void*) {
  object->RemoveObserver(static_cast<vtkCommand*>(observer));
  throw std::runtime_error("thrown by a test");
}
}  // namespace

extern "C" void palpate_throw_once(void* object) {
  vtkNew<vtkCallbackCommand> observer;
  observer->SetCallback(&Throw);
  observer->SetClientData(observer.Get());
  static_cast<vtkObject*>(object)->AddObserver(vtkCommand::ModifiedEvent, observer);
}

// SPDX-License-Identifier: BSD-3-Clause
// The border between exceptions and VTK: an exception that escapes a VTK entry point kills
// ParaView.
#pragma once

#include <exception>
#include <new>
#include <string>
#include <type_traits>
#include <utility>

#include "base/memory_error.h"
#include "base/printable.h"
#include "vtkObject.h"
#include "vtkSetGet.h"

/// Warns with a message that may contain text from a file, which is made printable.
inline void vtkPalpateWarn(vtkObject* self, const std::string& message)
{
  vtkWarningWithObjectMacro(self, << palpate::printable_message(message));
}

/// Calls `body()` and turns whatever it throws into exactly one error message of `self`; into none
/// where `self` is null.
/// @returns 0 after an error; else the result of `body`, or 1 if it has none. RequestData must
///   return 1 nevertheless, with empty outputs: after a 0 the executive adds a second message of
///   its own and runs the filter again at each render.
template <class Body>
int vtkPalpateGuard(vtkObject* self, Body&& body) noexcept
{
  const auto report = [self](const char* message) noexcept
  {
    try
    {
      if (self)
      {
        // The message may contain text from a file.
        vtkErrorWithObjectMacro(self, << palpate::printable_message(message));
      }
    }
    catch (...)
    {
      // There is not even enough memory for a message.
    }
    return 0;
  };
  try
  {
    if constexpr (std::is_void_v<std::invoke_result_t<Body>>)
    {
      std::forward<Body>(body)();
      return 1;
    }
    else
    {
      return std::forward<Body>(body)();
    }
  }
  catch (const std::bad_alloc&)
  {
    char text[palpate::kMemoryTextBytes];
    palpate::describe_memory(nullptr, text);
    return report(text);
  }
  catch (const std::exception& error)
  {
    return report(error.what());
  }
  catch (...)
  {
    return report("Unknown error.");
  }
}

// SPDX-License-Identifier: BSD-3-Clause
/// The border between exceptions and Qt. An exception that crosses an event loop ends ParaView.
#pragma once

#include <QString>
#include <exception>
#include <new>
#include <utility>

/// Calls `body()`.
/// @return The exception that it throws, in words; empty: it throws none.
template <class Body>
QString pqPalpateFault(Body&& body) noexcept
{
  try
  {
    std::forward<Body>(body)();
    return {};
  }
  catch (const std::bad_alloc&)
  {
    return "There is no memory left. Close what else needs much of it, and start again.";
  }
  catch (const std::exception& error)
  {
    const QString text = error.what();
    return text.isEmpty() ? QString("Unknown error.") : text;
  }
  catch (...)
  {
    return "Unknown error.";
  }
}

// SPDX-License-Identifier: BSD-3-Clause
/// The border between exceptions and Qt: one that crosses a loop of events ends ParaView.
#pragma once

#include <QString>
#include <exception>
#include <new>
#include <utility>

/// Calls `body()`.
/// @return What it throws, in words; empty: nothing.
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

// SPDX-License-Identifier: BSD-3-Clause
/// Hears Escape while ParaView handles no event, because one of its own filters or a server works.
///
/// A thread asks the X server which keys are pressed. It cannot tell which window the key is meant
/// for, so it asks only while ParaView's windows are silent. Where there is no X server it hears
/// nothing.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

class pqPalpateEscape
{
public:
  /// @param act It is called on another thread, again and again as long as the key is pressed while
  ///   the windows are silent.
  explicit pqPalpateEscape(std::function<void()> act);
  ~pqPalpateEscape();
  pqPalpateEscape(const pqPalpateEscape&) = delete;
  pqPalpateEscape& operator=(const pqPalpateEscape&) = delete;

  /// Says that the windows are handling events now.
  void HearsItself() { this->LastHeard = std::chrono::steady_clock::now(); }
  /// Whether the key was pressed while the windows were silent.
  bool WasPressed() const { return this->Pressed; }

private:
  void Listen();

  std::function<void()> Act;
  std::atomic<std::chrono::steady_clock::time_point> LastHeard;
  std::atomic<bool> Pressed{ false };
  std::atomic<bool> Ends{ false };
  std::thread Thread;
};

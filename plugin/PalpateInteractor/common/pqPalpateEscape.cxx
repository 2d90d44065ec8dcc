// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateEscape.h"

#include <X11/Xlib.h>
#include <X11/keysym.h>

#include <array>
#include <utility>

namespace
{
/// The time between two looks at the keys. A key that somebody presses is down for longer.
constexpr std::chrono::milliseconds Interval(20);
/// The windows count as silent after this time. While ParaView does nothing else it handles frames
/// more often.
constexpr std::chrono::milliseconds Silence(250);
}

pqPalpateEscape::pqPalpateEscape(std::function<void()> act)
  : Act(std::move(act))
  , LastHeard(std::chrono::steady_clock::now())
  , Thread([this] { this->Listen(); })
{
}

pqPalpateEscape::~pqPalpateEscape()
{
  this->Ends = true;
  this->Thread.join();
}

void pqPalpateEscape::Listen()
{
  // This thread needs a connection of its own and must not use that of the windows.
  Display* display = XOpenDisplay(nullptr);
  if (display == nullptr)
  {
    return;
  }
  const KeyCode escape = XKeysymToKeycode(display, XK_Escape);
  for (; !this->Ends; std::this_thread::sleep_for(Interval))
  {
    if (std::chrono::steady_clock::now() - this->LastHeard.load() < Silence)
    {
      continue;
    }
    std::array<char, 32> pressed{}; // a bit for each key
    XQueryKeymap(display, pressed.data());
    if ((pressed[escape / 8] >> (escape % 8)) & 1)
    {
      this->Act();
      this->Pressed = true;
    }
  }
  XCloseDisplay(display);
}

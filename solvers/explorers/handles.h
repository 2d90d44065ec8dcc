// SPDX-License-Identifier: BSD-3-Clause
// CZMQ's objects, destroyed when they go out of scope.
#pragma once

#include <czmq.h>

#include <memory>

namespace palpate {

struct DestroyHandle {
  void operator()(zcert_t* handle) const { zcert_destroy(&handle); }
  void operator()(zsock_t* handle) const { zsock_destroy(&handle); }
  void operator()(zactor_t* handle) const { zactor_destroy(&handle); }
  void operator()(zmsg_t* handle) const { zmsg_destroy(&handle); }
  void operator()(zframe_t* handle) const { zframe_destroy(&handle); }
  void operator()(zpoller_t* handle) const { zpoller_destroy(&handle); }
};
using Certificate = std::unique_ptr<zcert_t, DestroyHandle>;
using Socket = std::unique_ptr<zsock_t, DestroyHandle>;
using Actor = std::unique_ptr<zactor_t, DestroyHandle>;
using Parts = std::unique_ptr<zmsg_t, DestroyHandle>;
using Frame = std::unique_ptr<zframe_t, DestroyHandle>;
using Poller = std::unique_ptr<zpoller_t, DestroyHandle>;

/// Has CZMQ leave the signals of the program alone. Call this before any function of it.
void prepare_messages();

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "explorers/explorer_hub.h"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <utility>

#include "base/clock.h"
#include "base/error.h"
#include "explorers/handles.h"
#include "explorers/keys.h"
#include "explorers/wire.h"

namespace palpate {
namespace {

/// An explorer that says nothing for this time is lost, s. It says something twice a second, but
/// not while a large message is on its way: a connection has this many bytes a second at least.
constexpr double kSilence = 5;
constexpr double kSlowest = 1e6;
/// A job or a task of which an explorer does not know after this time was lost on the way, s.
constexpr double kUntilKnown = 2;
/// How long what was sent last may take to leave, ms.
constexpr int kLinger = 300;
/// The time between two messages to an explorer that solves, s. They cannot be sent to one whose
/// connection has ended.
constexpr double kBetweenProbes = 0.1;
/// The largest message that is taken, bytes. A configuration of a body of a million unknowns has
/// half of it.
constexpr std::int64_t kLargestMessage = std::int64_t{128} << 20;
/// Room for what is in a message beside the fields of a configuration, bytes.
constexpr std::int64_t kBesideFields = 1 << 20;
/// Not more messages are kept for an explorer that does not take them.
constexpr int kMostWaiting = 16;
/// Connections that may wait for their turn.
constexpr int kMostArriving = 1024;

/// CZMQ has one admission for a whole program.
std::atomic<bool> there_is_a_hub{false};

/// The largest message that an explorer of a session sends: a configuration with its fields.
std::int64_t most_bytes(const FollowSession& session) {
  const Scene& scene = *session.job().scene;
  const auto points = std::int64_t{scene.body.mesh.num_points()};
  const auto cells = std::int64_t{scene.body.mesh.num_cells()};
  // Displacements and at most four pressures a cell, with three columns of sensitivity.
  return kBesideFields + 8 * 4 * (3 * points + 4 * cells);
}

}  // namespace

class ExplorerHub::Impl {
 public:
  Impl(const std::filesystem::path& keys, const std::string& endpoint);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }
  void explore_for(FollowSession* session);
  bool exchange(double wait);
  [[nodiscard]] Figures figures() const;

 private:
  struct Member {
    bool is_ready = false;
    /// It has said that it cannot do the job.
    bool has_failed = false;
    /// The task that it has; 0: none.
    std::int64_t task = 0;
    /// When it was given the job or the task.
    SteadyClock::time_point given{};
    SteadyClock::time_point heard{};
  };

  void hear(const std::string& from, const WireMessage& message);
  /// Compares what an explorer says that it does with what it was given.
  void reconcile(const std::string& from, Member& member, const WireMessage& message);
  void take_result(Member& member, const WireMessage& message);
  void give_job(const std::string& to, Member& member);
  void give_tasks();
  void lose_silent();
  /// Forgets an explorer, and gives its task back.
  void lose(std::map<std::string, Member>::iterator member);
  void count_refused();

  std::string endpoint_;
  Actor admission_;
  Certificate key_;
  Socket socket_;
  /// Tells of connections that were refused.
  Actor watch_;
  FollowSession* session_ = nullptr;
  /// The number of the session, so that what is left of another one is known. It begins anywhere,
  /// since an explorer may come from another hub.
  std::int64_t job_ = std::int64_t{std::random_device()()} << 16;
  Bytes job_bytes_;
  /// The explorers by their addresses.
  std::map<std::string, Member> members_;
  SteadyClock::time_point probed_{};
  /// The time after which an explorer that says nothing is lost, s.
  double silence_ = kSilence;
  Figures figures_;
  bool has_found_ = false;
};

ExplorerHub::Impl::Impl(const std::filesystem::path& keys, const std::string& endpoint) {
  prepare_messages();
  if (there_is_a_hub.exchange(true)) {
    throw BackendError("A space is explored around a hand already. Stop that first.");
  }
  try {
    check_leader_keys(keys);
    key_.reset(zcert_load(leader_key(keys).c_str()));
    admission_.reset(zactor_new(zauth, nullptr));
    if (admission_ == nullptr) throw BackendError("CZMQ admits nobody.");
    zstr_sendx(admission_.get(), "CURVE", explorer_keys(keys).c_str(), nullptr);
    zsock_wait(admission_.get());
    socket_.reset(zsock_new(ZMQ_ROUTER));
    zcert_apply(key_.get(), socket_.get());
    zsock_set_curve_server(socket_.get(), 1);
    // Without an answer of the admission nobody comes in.
    zsock_set_zap_domain(socket_.get(), "palpate");
    zsock_set_zap_enforce_domain(socket_.get(), 1);
    zsock_set_linger(socket_.get(), kLinger);
    zsock_set_immediate(socket_.get(), 1);
    watch_connections(socket_.get());
    // What cannot be sent at once shall be known, and not waited for.
    zsock_set_router_mandatory(socket_.get(), 1);
    zsock_set_sndtimeo(socket_.get(), 0);
    zsock_set_sndhwm(socket_.get(), kMostWaiting);
    zsock_set_maxmsgsize(socket_.get(), static_cast<int>(kLargestMessage));
    // Many that come at once do not keep an explorer waiting.
    zsock_set_backlog(socket_.get(), kMostArriving);
    watch_.reset(zactor_new(zmonitor, socket_.get()));
    zstr_sendx(watch_.get(), "LISTEN", "HANDSHAKE_FAILED_NO_DETAIL", "HANDSHAKE_FAILED_PROTOCOL",
               "HANDSHAKE_FAILED_AUTH", nullptr);
    zstr_sendx(watch_.get(), "START", nullptr);
    zsock_wait(watch_.get());
    const bool goes_out = !endpoint.empty() && endpoint.front() == '>';
    if (zsock_attach(socket_.get(), endpoint.c_str(), !goes_out) != 0) {
      throw InputError(
          goes_out ? "The explorers at " + endpoint.substr(1) +
                         " cannot be reached: " + "this is no address. Give one as tcp://host:port."
                   : "Nothing can listen at " + endpoint + ": " + zmq_strerror(zmq_errno()) +
                         ". Choose another address or port.");
    }
    const char* at = zsock_endpoint(socket_.get());
    endpoint_ = at == nullptr ? endpoint : at;
  } catch (...) {
    there_is_a_hub = false;
    throw;
  }
}

ExplorerHub::Impl::~Impl() {
  for (const auto& [address, member] : members_) {
    send(socket_.get(), {WireKind::stop, job_, {}}, &address);
  }
  // One that has more to tell than fits does not end.
  count_refused();
  watch_.reset();
  socket_.reset();
  admission_.reset();
  there_is_a_hub = false;
}

void ExplorerHub::Impl::explore_for(FollowSession* session) {
  if (session != nullptr && most_bytes(*session) > kLargestMessage) {
    throw InputError(
        "The body is too large to be explored around a hand: a configuration has more than 128 MB. "
        "Take larger cells, or precompute the space.");
  }
  if (session_ != nullptr) {
    for (auto& [address, member] : members_) {
      if (member.task != 0) session_->lose(member.task);
    }
  }
  session_ = session;
  silence_ =
      kSilence + (session == nullptr ? 0 : static_cast<double>(most_bytes(*session)) / kSlowest);
  ++job_;
  job_bytes_ = session == nullptr ? Bytes() : pack(session->job());
  for (auto& [address, member] : members_) give_job(address, member);
}

bool ExplorerHub::Impl::exchange(double wait) {
  has_found_ = false;
  count_refused();
  if (wait > 0 && (zsock_events(socket_.get()) & ZMQ_POLLIN) == 0) {
    const Poller poller(zpoller_new(socket_.get(), nullptr));
    (void)zpoller_wait(poller.get(), static_cast<int>(1000 * wait));
  }
  for (;;) {
    bool is_garbage = false;
    std::string from;
    const auto message = receive(socket_.get(), is_garbage, &from);
    if (is_garbage) {
      ++figures_.num_refused;
      continue;
    }
    if (!message) break;
    hear(from, *message);
  }
  lose_silent();
  give_tasks();
  return has_found_;
}

void ExplorerHub::Impl::hear(const std::string& from, const WireMessage& message) {
  auto member = members_.find(from);
  if (message.kind == WireKind::hello) {
    if (message.bytes != wire_layout()) {
      ++figures_.num_refused;
      send(socket_.get(),
           {WireKind::refuse, 0,
            bytes_of("The explorer is of another version of Palpate, or of "
                     "another kind of machine, than the session.")},
           &from);
      return;
    }
    if (member == members_.end()) member = members_.emplace(from, Member()).first;
    Member& of = member->second;
    of.heard = SteadyClock::now();
    // What it had before it came back it has no more.
    if (session_ != nullptr && of.task != 0) session_->lose(of.task);
    give_job(from, of);
    return;
  }
  if (member == members_.end()) {
    send(socket_.get(), {WireKind::who, job_, {}}, &from);
    return;
  }
  Member& of = member->second;
  of.heard = SteadyClock::now();
  if (message.kind == WireKind::alive) return reconcile(from, of, message);
  if (message.job != job_) return;
  switch (message.kind) {
    case WireKind::ready: of.is_ready = true; break;
    case WireKind::result: take_result(of, message); break;
    case WireKind::failed:
      figures_.last_failure = text_of(message.bytes);
      of.is_ready = false;
      of.has_failed = true;
      break;
    default: break;
  }
}

void ExplorerHub::Impl::reconcile(const std::string& from, Member& member,
                                  const WireMessage& message) {
  if (session_ == nullptr || member.has_failed) return;
  if (seconds_since(member.given) < kUntilKnown) return;
  const std::int64_t task = number_of(message.bytes);
  if (message.job == job_ && (task == member.task || !member.is_ready)) return;
  if (member.task != 0) session_->lose(std::exchange(member.task, 0));
  if (message.job != job_) give_job(from, member);
}

void ExplorerHub::Impl::take_result(Member& member, const WireMessage& message) {
  const std::int64_t task = std::exchange(member.task, 0);
  if (session_ == nullptr || task == 0) return;
  std::optional<ExplorerResult> result;
  try {
    result = unpack_result(message.bytes);
  } catch (const BackendError&) {
    result.reset();
  }
  const bool is_of_task = result && result->number == task;
  if (!is_of_task) session_->lose(task);
  if (!is_of_task || !session_->accept(*result)) {
    // It is given nothing more.
    ++figures_.num_refused;
    figures_.last_failure = "An explorer has sent what it was not asked for.";
    member.is_ready = false;
    member.has_failed = true;
    return;
  }
  if (!result->failure.empty()) figures_.last_failure = result->failure;
  has_found_ = true;
}

void ExplorerHub::Impl::give_job(const std::string& to, Member& member) {
  member.is_ready = false;
  member.has_failed = false;
  member.task = 0;
  member.given = SteadyClock::now();
  send(socket_.get(), {WireKind::job, job_, job_bytes_}, &to);
}

void ExplorerHub::Impl::give_tasks() {
  if (session_ == nullptr) return;
  for (auto& [address, member] : members_) {
    if (!member.is_ready || member.task != 0) continue;
    const std::optional<ExplorerTask> task = session_->next();
    if (!task) return;
    member.task = task->number;
    member.given = SteadyClock::now();
    if (send(socket_.get(), {WireKind::task, job_, pack(*task)}, &address) == Sent::yes) continue;
    session_->lose(std::exchange(member.task, 0));
  }
}

void ExplorerHub::Impl::lose_silent() {
  const bool probes = seconds_since(probed_) > kBetweenProbes;
  if (probes) probed_ = SteadyClock::now();
  for (auto member = members_.begin(); member != members_.end();) {
    const auto next = std::next(member);
    const bool is_gone =
        probes && send(socket_.get(), {WireKind::alive, job_, {}}, &member->first) == Sent::gone;
    if (is_gone || seconds_since(member->second.heard) > silence_) lose(member);
    member = next;
  }
}

void ExplorerHub::Impl::lose(std::map<std::string, Member>::iterator member) {
  if (member->second.task != 0) {
    ++figures_.num_lost;
    if (session_ != nullptr) session_->lose(member->second.task);
  }
  members_.erase(member);
}

void ExplorerHub::Impl::count_refused() {
  while ((zsock_events(zactor_sock(watch_.get())) & ZMQ_POLLIN) != 0) {
    const Parts event(zmsg_recv(watch_.get()));
    if (event != nullptr) ++figures_.num_refused;
  }
}

ExplorerHub::Figures ExplorerHub::Impl::figures() const {
  Figures figures = figures_;
  figures.num_explorers = static_cast<int>(members_.size());
  figures.num_busy =
      static_cast<int>(std::count_if(members_.begin(), members_.end(),
                                     [](const auto& member) { return member.second.task != 0; }));
  return figures;
}

ExplorerHub::ExplorerHub(const std::filesystem::path& keys, const std::string& endpoint)
    : impl_(std::make_unique<Impl>(keys, endpoint)) {}
ExplorerHub::~ExplorerHub() = default;
const std::string& ExplorerHub::endpoint() const { return impl_->endpoint(); }
void ExplorerHub::explore_for(FollowSession* session) { impl_->explore_for(session); }
bool ExplorerHub::exchange(double wait) { return impl_->exchange(wait); }
ExplorerHub::Figures ExplorerHub::figures() const { return impl_->figures(); }

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "explorers/serve.h"

#include <unistd.h>

#include <chrono>
#include <exception>
#include <future>
#include <memory>
#include <optional>
#include <utility>

#include "base/clock.h"
#include "base/error.h"
#include "explorers/keys.h"
#include "explorers/wire.h"
#include "following/explorer.h"

namespace palpate {
namespace {

/// The time between two messages to the hub, s.
constexpr double kBetweenSigns = 0.5;
/// How long a message is waited for while nothing is done, and while something is, ms.
constexpr int kWaitIdle = 100;
constexpr int kWaitBusy = 2;

Socket make_socket(const ServeOptions& options) {
  check_explorer_keys(options.keys);
  const Certificate own(zcert_load(explorer_key(options.keys).c_str()));
  const Certificate leader(zcert_load(leader_key(options.keys).c_str()));
  if (own == nullptr || leader == nullptr) {
    throw InputError("The keys in " + options.keys.string() + " cannot be read.");
  }
  Socket socket(zsock_new(ZMQ_DEALER));
  zcert_apply(own.get(), socket.get());
  zsock_set_curve_serverkey(socket.get(), zcert_public_txt(leader.get()));
  zsock_set_linger(socket.get(), 0);
  // What cannot be sent at once is sent later, if it still counts.
  zsock_set_sndtimeo(socket.get(), 0);
  zsock_set_immediate(socket.get(), 1);
  watch_connections(socket.get());
  return socket;
}

/// What the explorer does. What takes time is done on a thread of its own, one thing after the
/// other, so that the hub hears from the explorer meanwhile.
class Service {
 public:
  explicit Service(const ServeOptions& options)
      : options_(options),
        socket_(make_socket(options)),
        watch_(zactor_new(zmonitor, socket_.get())),
        poller_(zpoller_new(socket_.get(), nullptr)) {
    zstr_sendx(watch_.get(), "LISTEN", "HANDSHAKE_FAILED_AUTH", nullptr);
    zstr_sendx(watch_.get(), "START", nullptr);
    zsock_wait(watch_.get());
    if (zsock_attach(socket_.get(), options.endpoint.c_str(), options.listens) != 0) {
      throw InputError(options.endpoint +
                       (options.listens ? " is no address of this machine." : " is no address.") +
                       " Give one as tcp://host:port.");
    }
  }
  ~Service() {
    is_dropped_ = true;
    if (work_.valid()) work_.wait();
  }
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  void run(const std::atomic<bool>& stop) {
    while (!stop && !is_done_) {
      (void)zpoller_wait(poller_.get(), work_.valid() ? kWaitBusy : kWaitIdle);
      bool is_garbage = false;
      while (const auto message = receive(socket_.get(), is_garbage)) hear(*message);
      finish();
      begin();
      answer();
      require_admission();
      if (options_.patience > 0 && seconds_since(heard_) > options_.patience) return;
      if (options_.parent > 0 && getppid() != options_.parent) return;
    }
  }

 private:
  /// What the thread has done: the explorer of a job, or the result of a task.
  struct Done {
    WireMessage answer;
    std::unique_ptr<Explorer> explorer;
  };

  void hear(const WireMessage& message) {
    heard_ = SteadyClock::now();
    switch (message.kind) {
      case WireKind::job:
        if (message.job == job_ && explorer_ != nullptr && !work_.valid()) {
          answer_ = WireMessage{WireKind::ready, job_, {}};
          // A task that came just before belongs to the job as it was given then.
          pending_.reset();
          task_ = 0;
          return;
        }
        if (message.job == job_ && is_preparing()) return;
        pending_ = message;
        is_dropped_ = true;
        return;
      case WireKind::task:
        if (message.job != job_) return;
        pending_ = message;
        is_dropped_ = true;
        return;
      case WireKind::who: send(socket_.get(), {WireKind::hello, job_, wire_layout()}); return;
      case WireKind::refuse: throw InputError(text_of(message.bytes));
      case WireKind::stop: is_done_ = true; return;
      default: return;
    }
  }

  /// Whether the thread makes the explorer of the job.
  [[nodiscard]] bool is_preparing() const { return work_.valid() && explorer_ == nullptr; }

  /// Takes what the thread has done.
  void finish() {
    if (!work_.valid()) return;
    if (work_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    Done done = work_.get();
    if (done.explorer != nullptr) explorer_ = std::move(done.explorer);
    if (!pending_) answer_ = std::move(done.answer);
  }

  /// Begins what was asked for last, once the thread has ended what it did.
  void begin() {
    if (!pending_ || work_.valid()) return;
    const WireMessage asked = *std::exchange(pending_, std::nullopt);
    answer_.reset();
    task_ = 0;
    is_dropped_ = false;
    if (asked.kind == WireKind::job) {
      job_ = asked.job;
      explorer_.reset();
      if (asked.bytes.empty()) return;
      work_ = std::async(std::launch::async, [this, asked] { return prepare(asked); });
    } else if (explorer_ != nullptr) {
      try {
        ExplorerTask task = unpack_task(asked.bytes);
        task_ = task.number;
        work_ = std::async(std::launch::async, [this, task = std::move(task)] {
          return Done{{WireKind::result, job_, pack(explorer_->make(task))}, nullptr};
        });
      } catch (const BackendError& error) {
        answer_ = WireMessage{WireKind::failed, job_, bytes_of(error.what())};
      }
    }
  }

  [[nodiscard]] Done prepare(const WireMessage& asked) {
    try {
      auto explorer = std::make_unique<Explorer>(unpack_job(asked.bytes),
                                                 [this] { return is_dropped_.load(); });
      return {{WireKind::ready, asked.job, {}}, std::move(explorer)};
    } catch (const std::exception& error) {
      return {{WireKind::failed, asked.job, bytes_of(error.what())}, nullptr};
    }
  }

  /// Sends the answer that is due, and a sign of life.
  void answer() {
    if (answer_ && send(socket_.get(), *answer_) == Sent::yes) {
      answer_.reset();
      task_ = 0;
    }
    if (seconds_since(said_) < kBetweenSigns) return;
    said_ = SteadyClock::now();
    send(socket_.get(), {WireKind::alive, job_, bytes_of(task_)});
  }

  void require_admission() {
    if ((zsock_events(zactor_sock(watch_.get())) & ZMQ_POLLIN) == 0) return;
    const Parts event(zmsg_recv(watch_.get()));
    throw InputError("The session does not admit the key " + explorer_key(options_.keys).string() +
                     ". Copy the keys of the session, or add this public key to its explorers.");
  }

  const ServeOptions& options_;
  Socket socket_;
  /// Tells whether the key of this explorer is refused.
  Actor watch_;
  Poller poller_;
  /// The number of the job that the explorer is of, and of the task that is being made or whose
  /// result waits to be sent; 0: none.
  std::int64_t job_ = 0;
  std::int64_t task_ = 0;
  /// Whether what the thread does is not wanted any more.
  std::atomic<bool> is_dropped_{false};
  std::unique_ptr<Explorer> explorer_;
  std::future<Done> work_;
  /// The job or the task that was asked for last.
  std::optional<WireMessage> pending_;
  std::optional<WireMessage> answer_;
  SteadyClock::time_point said_{};
  SteadyClock::time_point heard_ = SteadyClock::now();
  bool is_done_ = false;
};

}  // namespace

void serve_explorer(const ServeOptions& options, const std::atomic<bool>& stop) {
  Service(options).run(stop);
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
// palpate-explore: explores a state space around a hand for a session that runs elsewhere.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <iostream>

#include "base/error.h"
#include "explorers/keys.h"
#include "explorers/serve.h"

namespace {

std::atomic<bool> stop{false};

void on_signal(int /*signal*/) { stop = true; }

/// The rank of this process in a job of several, which mpiexec or srun tells.
int rank_of_job() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID"}) {
    if (const char* rank = std::getenv(name)) return std::atoi(rank);
  }
  return 0;
}

/// The address with a port that is larger by a number.
std::string with_port_behind(const std::string& address, int by) {
  const std::size_t colon = address.rfind(':');
  const int port = colon == std::string::npos ? 0 : std::atoi(address.c_str() + colon + 1);
  if (port <= 0) {
    throw palpate::InputError(address + " has no port. Give an address as tcp://host:port.");
  }
  return address.substr(0, colon + 1) + std::to_string(port + by);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Explores a state space around a hand. The session says where it listens; the explorer "
      "needs its keys.");
  palpate::ServeOptions options;
  std::string keys;
  bool makes_keys = false;
  int nice_value = 0;
  app.add_option("--keys", keys, "the folder of the keys")->required();
  auto* connect = app.add_option("--connect", options.endpoint,
                                 "where the session listens, as tcp://host:port");
  auto* listen = app.add_option("--listen", options.endpoint,
                                "where the session may come to instead, as tcp://127.0.0.1:5700; "
                                "in a job of several ranks, each takes the port behind the one "
                                "before");
  connect->excludes(listen);
  app.add_flag("--make-keys", makes_keys, "make the keys, if there are none, and end");
  app.add_option("--patience", options.patience,
                 "end once the session has said nothing for this time, s; 0: never")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--nice", nice_value, "how far to step back behind other programs")
      ->check(CLI::Range(0, 19));
  app.add_option("--parent", options.parent,
                 "end with this process, which has started this program");
  CLI11_PARSE(app, argc, argv);
  try {
    if (nice_value > 0) setpriority(PRIO_PROCESS, 0, nice_value);
    options.keys = keys;
    if (makes_keys) {
      palpate::make_keys(options.keys);
      return 0;
    }
    if (options.endpoint.empty()) {
      throw palpate::InputError("Give --connect or --listen.");
    }
    options.listens = listen->count() > 0;
    if (options.listens) options.endpoint = with_port_behind(options.endpoint, rank_of_job());
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    palpate::serve_explorer(options, stop);
  } catch (const std::exception& error) {
    std::cerr << "palpate-explore: " << error.what() << '\n';
    return 1;
  }
  return 0;
}

// Trajectories of other systems, in the same tables as ours.
#pragma once

#include <filesystem>
#include <string>

#include "bench/bench_run.h"
#include "util/status.h"

namespace msf {

// A folder of trajectories: SEQUENCE.EXT, or SEQUENCE_1.EXT, SEQUENCE_2.EXT ... for several runs,
// where SEQUENCE is a sequence's name in the suite or its folder's name. For the forms see
// ReadForeignTrajectory().
struct Peer {
  std::string name;
  std::filesystem::path folder;
};

// Reads "NAME=FOLDER".
StatusOr<Peer> ParsePeer(const std::string& text);

// Evaluates what the folder has for the sequences of the plan and adds it as one more system. What
// cannot be evaluated is a result that says why.
Status AddPeer(const Peer& peer, BenchResults& results);

}  // namespace msf

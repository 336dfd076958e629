// A suite: which sequences are run in which variants and how often. A small YAML file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "util/status.h"

namespace msf {

// A recorded data set in TUM layout, or a scenario of the simulator.
struct SuiteSequence {
  std::string name;
  std::string published_as;
  std::string folder;
  std::string camera;
  std::string address;
  std::string scenario;
  uint64_t seed = 1;
  int frames = 0;
  bool without_actors = false;
  std::vector<std::string> settings;
  std::string calm;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("name", name, "in the tables and in file names");
    visit("published_as", published_as, "name of the sequence in tables of the literature");
    visit("folder", folder, "recorded: folder as the data set unpacks, below one of the roots");
    visit("camera", camera, "recorded: preset or YAML file; empty: camera.yaml in the folder");
    visit("address", address, "recorded: where the data set can be had");
    visit("scenario", scenario, "simulated: name or YAML file of the scenario");
    visit("seed", seed, "simulated: of the world");
    visit("frames", frames, "simulated: rendered; 0: as long as the scenario says");
    visit("without_actors", without_actors, "simulated: leave out what moves");
    visit("settings", settings, "simulated: changes of the scenario, key=value");
    visit("calm", calm,
          "the sequence with the same path and nobody in it: errors are also given as a ratio to "
          "the baseline's there");
  }
};

// How the system is set up.
struct SuiteVariant {
  std::string name;
  std::string about;
  std::string dynamic;
  std::string detector;
  std::string config;
  std::vector<std::string> set;
  std::string mode;
  int repeats = 0;
  double time_limit_s = 0;
  double threshold_px = 0;
  std::vector<std::string> sequences;
  std::string program;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("name", name, "in the tables and in file names");
    visit("about", about, "for the reader");
    visit("dynamic", dynamic, "--dynamic of msf-slam run");
    visit("detector", detector, "--detector of msf-slam run");
    visit("config", config, "--config of msf-slam run; relative to the suite's file");
    visit("set", set, "--set of msf-slam run: section.key=value");
    visit("mode", mode, "deterministic, threaded or realtime; empty: the suite's");
    visit("repeats", repeats, "0: the suite's");
    visit("time_limit_s", time_limit_s, "0: the suite's");
    visit("threshold_px", threshold_px, "L of table 1: the motion threshold of this variant, px");
    visit("sequences", sequences, "only these; empty: all");
    visit("program", program, "another build of msf-slam to compare with; empty: this one");
  }
};

// A detector for tables 3 and 4.
struct SuiteDetector {
  std::string name;
  std::string model;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("name", name, "in the tables");
    visit("model", model, "ONNX file, or the name of a model that ships");
  }
};

struct DetectorData {
  std::string folder;
  std::string address;
  std::string size = "320x320";
  int limit = 0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("folder", folder, "in PASCAL VOC layout below one of the roots; its test set is used");
    visit("address", address, "where the data set can be had");
    visit("size", size, "input of the network, WIDTHxHEIGHT");
    visit("limit", limit, "use the first images only; 0: all");
  }
};

struct Suite {
  std::string name;
  std::string description;
  std::string mode = "deterministic";
  int repeats = 1;
  uint64_t seed = 0;
  double time_limit_s = 1800;
  int max_frames = 0;
  bool score_masks = true;
  int picture_sequences = 2;
  std::string baseline = "off";
  std::string ours = "full";
  std::vector<SuiteSequence> sequences;
  std::vector<SuiteVariant> variants;
  std::vector<SuiteDetector> detectors;
  DetectorData detector_data;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("name", name, "empty: that of the file");
    visit("description", description, "what the suite is for");
    visit("mode", mode,
          "deterministic: one thread, equal bytes; threaded; realtime: at the camera's pace");
    visit("repeats", repeats, "runs of every variant on every sequence");
    visit("seed", seed, "of the first repeat; the next one has the next seed");
    visit("time_limit_s", time_limit_s, "a run that takes longer is killed and reported, s");
    visit("max_frames", max_frames, "of every sequence; 0: all");
    visit("score_masks", score_masks,
          "where a sequence has true masks: what share of the points was rightly removed and kept");
    visit("picture_sequences", picture_sequences,
          "figure 4 shows what the detectors find in pictures of so many sequences");
    visit("baseline", baseline, "variant that stands where the paper has ORB-SLAM3");
    visit("ours", ours, "variant that stands where the paper has MSF-SLAM");
    visit("sequences", sequences, "");
    visit("variants", variants, "");
    visit("detectors", detectors, "");
    visit("detector_data", detector_data, "");
  }
  // The first thing that makes no sense, as a sentence.
  Status Check() const;

  // Takes out all others; no names: keeps all. An error when there is none of that name.
  Status KeepOnly(const std::vector<std::string>& sequence_names,
                  const std::vector<std::string>& variant_names);

  const SuiteSequence* FindSequence(const std::string& sequence) const;
  const SuiteVariant* FindVariant(const std::string& variant) const;
};

// The mode in which a variant runs, and how often.
std::string ModeOf(const Suite& suite, const SuiteVariant& variant);
int RepeatsOf(const Suite& suite, const SuiteVariant& variant);

// The YAML file of that name, else the suite of that name that ships. Errors name the file and the
// key, or list the names.
StatusOr<Suite> LoadSuite(const std::string& name_or_file);
// What ships, in order of the alphabet.
std::vector<std::string> SuiteNames();

}  // namespace msf

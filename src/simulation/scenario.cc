#include "simulation/scenario.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "sensor/camera.h"
#include "simulation/embedded_scenarios.h"
#include "simulation/world.h"
#include "util/options.h"

namespace msf {
namespace {

// Far more than anybody waits for, and few enough to be counted by an int and kept in memory.
constexpr int kMaxFrames = 1'000'000;
constexpr double kMaxDuration_s = 86'400;
// Beyond it, a double tells microseconds no longer apart.
constexpr double kMaxStart_s = 1e10;

}  // namespace

Status Scenario::Check() const {
  const std::vector<std::string> worlds = WorldNames();
  if (std::find(worlds.begin(), worlds.end(), world) == worlds.end()) {
    return Status::Error(
        fmt::format("world is '{}'; known are {}", world, fmt::join(worlds, ", ")));
  }
  const StatusOr<Camera> preset = Camera::Preset(camera);
  if (!preset.ok()) return preset.status();
  if (!(std::abs(focal_error) < 0.1)) return Status::Error("focal_error must be in (-0.1, 0.1)");
  if (!(fps > 0 && duration_s * fps >= 1 && duration_s * fps < kMaxFrames + 1 &&
        duration_s <= kMaxDuration_s)) {
    return Status::Error(
        fmt::format("duration_s and fps must give at least one frame, at most {} frames in {} s",
                    kMaxFrames, kMaxDuration_s));
  }
  if (!(std::abs(start_time_s) <= kMaxStart_s))
    return Status::Error(fmt::format("start_time_s must be within {} s of 0", kMaxStart_s));
  if (!(time_jitter_s >= 0 && time_jitter_s * 8 < 1 / fps)) {
    return Status::Error(
        "time_jitter_s must be below an eighth of the frame time, or frames would change places");
  }
  for (const std::vector<TimeSpan>& spans : {blackouts, depth_gaps}) {
    for (const TimeSpan& span : spans) {
      if (!(span.to_s > span.from_s)) {
        return Status::Error("blackouts and depth_gaps: to_s must be after from_s");
      }
    }
  }
  for (const Dimming& dimming : dimmings) {
    if (!(dimming.to_s > dimming.from_s))
      return Status::Error("dimmings: to_s must be after from_s");
    if (!(dimming.level >= 0 && dimming.level <= 1)) {
      return Status::Error("dimmings: level must be in [0, 1]");
    }
  }
  for (size_t i = 1; i < jumps.size(); ++i) {
    if (!(jumps[i].time_s > jumps[i - 1].time_s))
      return Status::Error("jumps must be in order of time_s");
  }
  for (const ActorOptions& actor : actors) MSF_RETURN_IF_ERROR(actor.Check());
  MSF_RETURN_IF_ERROR(path.Check());
  MSF_RETURN_IF_ERROR(color.Check());
  return depth.Check();
}

double Scenario::LightAt(double elapsed_s) const {
  constexpr double kChange_s = 0.2;
  double light = 1;
  for (const Dimming& dimming : dimmings) {
    const double since_change_s = std::min(elapsed_s - dimming.from_s, dimming.to_s - elapsed_s);
    light *= 1 - (1 - dimming.level) * std::clamp(since_change_s / kChange_s, 0., 1.);
  }
  return light;
}

StatusOr<Scenario> LoadScenario(const std::string& name_or_file) {
  Scenario scenario;
  scenario.name = std::filesystem::path(name_or_file).stem().string();
  const auto known = EmbeddedScenarios().find(name_or_file);
  Status status;
  std::error_code ignored;
  if (known != EmbeddedScenarios().end()) {
    status = ReadOptions(YAML::Load(known->second), scenario);
  } else if (std::filesystem::is_regular_file(name_or_file, ignored)) {
    MSF_RETURN_IF_ERROR(LoadOptions(name_or_file, scenario));
  } else {
    return Status::Error(
        fmt::format("'{}' is neither a scenario file nor a known scenario; known are {}",
                    name_or_file, fmt::join(ScenarioNames(), ", ")));
  }
  if (status.ok()) status = scenario.Check();
  if (!status.ok())
    return Status::Error(fmt::format("scenario {}: {}", name_or_file, status.message()));
  return scenario;
}

std::vector<std::string> ScenarioNames() {
  std::vector<std::string> names;
  for (const auto& [name, text] : EmbeddedScenarios()) names.push_back(name);
  return names;
}

}  // namespace msf

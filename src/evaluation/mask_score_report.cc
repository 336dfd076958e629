#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "evaluation/mask_score.h"

namespace msf {
namespace {

std::string SizeName(int size_class) {
  const auto i = static_cast<size_t>(size_class);
  if (i + 1 == kActorSizes.size()) return fmt::format("over {:g} %", 100 * kActorSizes[i]);
  return fmt::format("{:g} to {:g} %", 100 * kActorSizes[i], 100 * kActorSizes[i + 1]);
}

std::string FormatTally(const char* where, const PointTally& tally) {
  std::string text = fmt::format("  {:<28}{:>10}   removed {:5.1f} %", where, tally.Total(),
                                 100 * tally.RemovedShare());
  for (int i = 0; i < kNumPointReasons; ++i) {
    const auto reason = static_cast<PointReason>(i);
    if (tally.by_reason[i] > 0)
      text += fmt::format(", {} {:.1f} %", ToString(reason), 100 * tally.Share(reason));
  }
  return text + "\n";
}

nlohmann::json TallyToJson(const PointTally& tally) {
  nlohmann::json counts = nlohmann::json::object();
  for (int i = 0; i < kNumPointReasons; ++i)
    counts[ToString(static_cast<PointReason>(i))] = tally.by_reason[i];
  return {{"points", tally.Total()},
          {"by_reason", std::move(counts)},
          {"removed_share", tally.RemovedShare()},
          {"kept_share", tally.KeptShare()},
          {"settled_share", tally.Share(PointReason::kSettled)},
          {"readmitted_share", tally.Share(PointReason::kReadmitted)}};
}

}  // namespace

std::string FormatMaskScore(const MaskScore& score) {
  std::string text = fmt::format("{} against true masks: {} frames", score.name, score.num_frames);
  if (score.num_frames_without_mask > 0)
    text += fmt::format(" ({} more have no mask)", score.num_frames_without_mask);
  text += "\n" + FormatTally("points on movers", score.on_movers) +
          FormatTally("points elsewhere", score.on_static);
  text += fmt::format("  {:<28}{:>10}   within {} px of a mask's border, in neither count\n",
                      "points left out", score.near_border, kMaskBorder_px);
  text += fmt::format(
      "  dynamic points: precision {:.1f} %, recall {:.1f} %; static points kept {:.1f} %\n",
      100 * score.Precision(), 100 * score.Recall(), 100 * score.on_static.KeptShare());
  text += "  settled and readmitted points are used with little weight: kept, not removed\n";
  if (score.actors.empty()) return text;
  text += fmt::format("  {:<28}{:>10}{:>11}{:>11}\n", "movers by share of the image", "visible",
                      "detected", "followed");
  for (const ActorTally& tally : score.actors) {
    const double percent = 100.0 / static_cast<double>(tally.visible);
    text += fmt::format("  {:<28}{:>10}{:>9.1f} %{:>9.1f} %\n",
                        tally.class_name + ", " + SizeName(tally.size_class), tally.visible,
                        percent * static_cast<double>(tally.detected),
                        percent * static_cast<double>(tally.followed));
  }
  return text;
}

nlohmann::json MaskScoreToJson(const MaskScore& score) {
  nlohmann::json actors = nlohmann::json::array();
  for (const ActorTally& tally : score.actors) {
    actors.push_back({{"class", tally.class_name},
                      {"min_image_share", kActorSizes[static_cast<size_t>(tally.size_class)]},
                      {"visible", tally.visible},
                      {"detected", tally.detected},
                      {"followed", tally.followed}});
  }
  return {{"name", score.name},
          {"frames", score.num_frames},
          {"frames_without_mask", score.num_frames_without_mask},
          {"dynamic", TallyToJson(score.on_movers)},
          {"static", TallyToJson(score.on_static)},
          {"near_border", score.near_border},
          {"border_px", kMaskBorder_px},
          {"precision", score.Precision()},
          {"recall", score.Recall()},
          {"static_kept", score.on_static.KeptShare()},
          {"actors", std::move(actors)}};
}

}  // namespace msf

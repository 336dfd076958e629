#include "feature/orb_extractor.h"

#include <cmath>

#include "feature/brief_pattern.h"
#include "feature/even_distribution.h"
#include "feature/fast_corners.h"
#include "feature/image_pyramid.h"
#include "feature/point_depth.h"
#include "feature/score_peak.h"
#include "feature/smoothing.h"
#include "feature/steered_brief.h"

namespace msf {
namespace {

// A turned patch and the 7x7 smoothing around each of its samples stay inside the image.
constexpr int kBorderPx = kPatchRadiusPx + 4;

// Depth, undistorted position and virtual stereo of points whose image position is known.
void AddGeometry(const RgbdFrame& frame, const Rigid3d& T_depth_color, FrameFeatures& features) {
  const Camera& camera = *frame.camera;
  const size_t size = features.image_px.size();
  features.uv_px.resize(size);
  features.depth_m.resize(size);
  features.u_right_px.resize(size);
  features.static_weight.assign(size, 1.0f);
  for (size_t i = 0; i < size; ++i) {
    features.uv_px[i] = camera.Undistort(features.image_px[i].cast<double>()).cast<float>();
    const float depth_m =
        frame.depth_delay_s == 0
            ? PointDepth(frame.depth, features.image_px[i], camera.depth_factor)
            : PointDepthFromElsewhere(frame.depth, features.uv_px[i], camera, T_depth_color);
    features.depth_m[i] = depth_m;
    features.u_right_px[i] =
        depth_m > 0 ? features.uv_px[i].x() - static_cast<float>(camera.bf) / depth_m : -1.0f;
  }
  features.BuildGrid(camera);
}

}  // namespace

Status OrbOptions::Check() const {
  if (num_features < 1) return Status::Error("feature.num_features must be at least 1");
  if (num_levels < 1 || num_levels > 32)
    return Status::Error("feature.num_levels must be from 1 to 32");
  if (!(scale_factor > 1 && scale_factor <= 4))
    return Status::Error("feature.scale_factor must be above 1 and at most 4");
  if (min_fast_threshold < 1 || fast_threshold < min_fast_threshold || fast_threshold > 254) {
    return Status::Error("feature: 1 <= min_fast_threshold <= fast_threshold <= 254 is needed");
  }
  if (cell_size_px < 1) return Status::Error("feature.cell_size_px must be at least 1");
  if (!(even_share >= 0 && even_share <= 1))
    return Status::Error("feature.even_share must be from 0 to 1");
  return Status::Ok();
}

struct OrbExtractor::Buffers {
  std::vector<cv::Mat> pyramid;
  cv::Mat converted;  // from colour to grey
  cv::Mat scores;     // of the first level's size; each level uses a part
  cv::Mat smoothed;
  std::vector<Corner> corners;
};

OrbExtractor::OrbExtractor(const OrbOptions& options)
    : options_(options),
      levels_(options.num_levels, options.scale_factor),
      buffers_(std::make_unique<Buffers>()) {
  const Status status = options.Check();
  MSF_CHECK(status.ok(), status.message());
}

OrbExtractor::~OrbExtractor() = default;

FrameFeatures OrbExtractor::Extract(const RgbdFrame& frame, const Rigid3d& T_depth_color) {
  return Extract(frame, options_.num_features, T_depth_color);
}

FrameFeatures OrbExtractor::Extract(const RgbdFrame& frame, int num_features,
                                    const Rigid3d& T_depth_color) {
  const Status status = CheckFrame(frame);
  MSF_CHECK(status.ok(), status.message());
  BuildPyramid(ToGrey(frame.color, buffers_->converted), levels_, buffers_->pyramid);
  buffers_->scores.create(frame.color.size(), CV_8UC1);
  buffers_->smoothed.create(frame.color.size(), CV_8UC1);
  FrameFeatures features;
  const std::vector<int> quotas = LevelQuotas(levels_, num_features);
  for (int level = 0; level < static_cast<int>(buffers_->pyramid.size()); ++level) {
    ExtractLevel(level, quotas[level], features);
  }
  AddGeometry(frame, T_depth_color, features);
  return features;
}

void OrbExtractor::ExtractLevel(int level, int quota, FrameFeatures& features) {
  const cv::Mat& image = buffers_->pyramid[level];
  const cv::Rect area(kBorderPx, kBorderPx, image.cols - 2 * kBorderPx, image.rows - 2 * kBorderPx);
  if (area.width < 1 || area.height < 1) return;
  std::vector<Corner>& corners = buffers_->corners;
  cv::Mat scores = buffers_->scores(cv::Rect({0, 0}, image.size()));
  cv::Mat smoothed = buffers_->smoothed(cv::Rect({0, 0}, image.size()));
  // Two pixels more: the peak search looks at neighbours, its refinement at theirs.
  SmoothForCorners(image, smoothed);
  ComputeFastScores(smoothed, {area.x - 2, area.y - 2, area.width + 4, area.height + 4}, scores);
  corners.clear();
  FindScorePeaks(scores, area, options_.min_fast_threshold, corners);
  KeepStrongPerCell(area, options_.cell_size_px, options_.fast_threshold, corners);
  const std::vector<Corner> chosen = DistributeEvenly(area, quota, options_.even_share, corners);
  if (chosen.empty()) return;

  SmoothForDescriptors(image, smoothed);
  const cv::Mat& first = buffers_->pyramid[0];
  const Eigen::Vector2f scale(static_cast<float>(first.cols) / image.cols,
                              static_cast<float>(first.rows) / image.rows);
  for (const Corner& corner : chosen) {
    const float angle_rad = PatchOrientation(image, corner.x, corner.y);
    Eigen::Vector2f offset = Eigen::Vector2f::Zero();
    if (options_.subpixel) offset = RefineScorePeak(scores, corner.x, corner.y);
    // The corners of the levels coincide, not the centres of their first pixels, which lie half a
    // pixel inside.
    const Eigen::Vector2f centre = Eigen::Vector2f(corner.x + 0.5f, corner.y + 0.5f) + offset;
    features.image_px.push_back(centre.cwiseProduct(scale) - Eigen::Vector2f(0.5f, 0.5f));
    features.angle_rad.push_back(angle_rad);
    features.level.push_back(static_cast<uint8_t>(level));
    features.descriptors.push_back(DescribePatch(smoothed, corner.x, corner.y, offset, angle_rad));
  }
}

std::vector<int> LevelQuotas(const ScaleLevels& levels, int num_features) {
  double sum = 0;
  for (int level = 0; level < levels.size(); ++level) sum += 1 / levels.scale(level);
  std::vector<int> quotas(levels.size());
  double before = 0;
  for (int level = 0; level < levels.size(); ++level) {
    const double share = num_features / levels.scale(level) / sum;
    // Rounding the running sum makes the parts add up.
    quotas[level] = static_cast<int>(std::lround(before + share) - std::lround(before));
    before += share;
  }
  return quotas;
}

}  // namespace msf

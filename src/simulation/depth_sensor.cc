#include "simulation/depth_sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace msf {
namespace {

constexpr int kTile = 1024;  // side of the noise field, a power of two

// A pixel is at an edge when a neighbour's disparity differs by more than this, px: more than any
// slanted surface in view.
constexpr float kEdgeDisparity_px = 1.0f;

}  // namespace

Status DepthSensorOptions::Check() const {
  if (!(noise_per_m >= 0 && noise_per_m < 0.1))
    return Status::Error("depth.noise_per_m must be in [0, 0.1)");
  if (!(distortion_px >= 0 && distortion_px < 1)) {
    return Status::Error("depth.distortion_px must be in [0, 1)");
  }
  if (!(disparity_steps > 0)) return Status::Error("depth.disparity_steps must be positive");
  if (!(nearest_m >= 0 && farthest_m > nearest_m))
    return Status::Error("depth: farthest_m must exceed nearest_m >= 0");
  if (!(edge_dropout >= 0 && edge_dropout <= 1))
    return Status::Error("depth.edge_dropout must be in [0, 1]");
  if (!(grazing_deg > 0 && grazing_deg <= 90))
    return Status::Error("depth.grazing_deg must be in (0, 90]");
  return Status::Ok();
}

DepthSensor::DepthSensor(const DepthSensorOptions& options, const Camera& camera, Random random)
    : options_(options), camera_(camera), noise_(kTile, kTile, CV_32FC1) {
  cv::RNG rng(random.Next());
  rng.fill(noise_, cv::RNG::NORMAL, 0, 1);
  cv::GaussianBlur(noise_, noise_, {5, 5}, 0.8);
  cv::Scalar mean, deviation;
  cv::meanStdDev(noise_, mean, deviation);
  noise_ = (noise_ - mean[0]) / deviation[0];
  MakeDistortion(random.Fork(1));
}

// A random mixture of the lowest polynomials over the image, of mean zero.
void DepthSensor::MakeDistortion(Random random) {
  distortion_px_.create(camera_.height, camera_.width, CV_32FC1);
  double weights[5];
  for (double& weight : weights) weight = random.Uniform(0.3, 1) * (random.Chance(0.5) ? 1 : -1);
  for (int row = 0; row < camera_.height; ++row) {
    for (int column = 0; column < camera_.width; ++column) {
      const double x = 2.0 * column / camera_.width - 1, y = 2.0 * row / camera_.height - 1;
      const double terms[5] = {x, y, x * y, x * x - 1.0 / 3, y * y - 1.0 / 3};
      double sum = 0;
      for (int i = 0; i < 5; ++i) sum += weights[i] * terms[i];
      distortion_px_.at<float>(row, column) = static_cast<float>(sum);
    }
  }
  const double largest = cv::norm(distortion_px_, cv::NORM_INF);
  distortion_px_ *= options_.distortion_px / largest;
}

// The projector stands to the side of the camera by the baseline, so a surface point of disparity d
// is lit by projector column x - d. Going from right to left, a column that something nearer has
// taken already gets no light.
void DepthSensor::FindShadow(const float* disparity, uint8_t* hidden) const {
  float taken = std::numeric_limits<float>::max();
  for (int x = camera_.width - 1; x >= 0; --x) {
    const float column = static_cast<float>(x) - disparity[x];
    hidden[x] = column > taken + 0.5f;
    taken = std::min(taken, column);
  }
}

void DepthSensor::MarkEdges(const cv::Mat& disparity, int y, uint8_t* edge) const {
  const float* row = disparity.ptr<float>(y);
  const float* above = disparity.ptr<float>(std::max(0, y - 1));
  const float* below = disparity.ptr<float>(std::min(disparity.rows - 1, y + 1));
  const int last = disparity.cols - 1;
  for (int x = 1; x < last; ++x) {
    const float d = row[x];
    edge[x] = std::abs(row[x - 1] - d) > kEdgeDisparity_px ||
              std::abs(row[x + 1] - d) > kEdgeDisparity_px ||
              std::abs(above[x] - d) > kEdgeDisparity_px ||
              std::abs(below[x] - d) > kEdgeDisparity_px;
  }
  edge[0] = edge[last] = 1;
}

cv::Mat DepthSensor::Measure(const RenderedView& view, Random random) const {
  cv::Mat depth(camera_.height, camera_.width, CV_16UC1);
  if (options_.perfect) {
    view.depth_m.convertTo(depth, CV_16UC1, camera_.depth_factor);
    return depth;
  }
  cv::Mat disparity(camera_.height, camera_.width, CV_32FC1);
  const float bf = static_cast<float>(camera_.bf);
  for (int y = 0; y < disparity.rows; ++y) {
    const float* z = view.depth_m.ptr<float>(y);
    float* d = disparity.ptr<float>(y);
    for (int x = 0; x < disparity.cols; ++x) d[x] = z[x] > 0 ? bf / z[x] : 0;
  }
  const cv::Point shift(random.Int(0, kTile - 1), random.Int(0, kTile - 1));
  std::vector<uint8_t> hidden(camera_.width, 0), edge(camera_.width);
  for (int y = 0; y < depth.rows; ++y) {
    if (options_.shadow) FindShadow(disparity.ptr<float>(y), hidden.data());
    MarkEdges(disparity, y, edge.data());
    const Row row{y,
                  hidden.data(),
                  edge.data(),
                  view.cosine.ptr<float>(y),
                  noise_.ptr<float>((y + shift.y) % kTile),
                  shift.x};
    MeasureRow(disparity, row, random, depth.ptr<uint16_t>(y));
  }
  return depth;
}

void DepthSensor::MeasureRow(const cv::Mat& disparity, const Row& row, Random& random,
                             uint16_t* depth) const {
  const float bf = static_cast<float>(camera_.bf),
              factor = static_cast<float>(camera_.depth_factor);
  const float steps = static_cast<float>(options_.disparity_steps);
  const float sigma_px = static_cast<float>(options_.noise_per_m) * bf;  // dz = z^2 / bf * dd
  const float lowest = bf / static_cast<float>(options_.farthest_m);
  const float highest = bf / std::max(0.01f, static_cast<float>(options_.nearest_m));
  const float grazing = static_cast<float>(std::cos(options_.grazing_deg * std::numbers::pi / 180));
  const float* disparities = disparity.ptr<float>(row.y);
  const float* distortion = distortion_px_.ptr<float>(row.y);
  for (int x = 0; x < disparity.cols; ++x) {
    depth[x] = 0;
    if (row.hidden[x]) continue;
    float d = disparities[x];
    if (row.edge[x]) {
      // The matching window sees both sides: either none or a neighbour's depth comes out.
      if (random.Chance(options_.edge_dropout)) continue;
      const int neighbor_x = std::clamp(x + random.Int(-1, 1), 0, disparity.cols - 1);
      d = disparity.at<float>(std::clamp(row.y + random.Int(-1, 1), 0, disparity.rows - 1),
                              neighbor_x);
    }
    if (d <= 0) continue;
    if (row.cosine[x] < grazing && random.Chance(1.2 * (1 - row.cosine[x] / grazing))) continue;
    d += distortion[x] + sigma_px * row.noise[(x + row.noise_shift) % kTile];
    d = std::floor(d * steps + 0.5f) / steps;
    if (d < lowest || d > highest) continue;
    depth[x] = static_cast<uint16_t>(std::min(65535.f, bf / d * factor + 0.5f));
  }
}

}  // namespace msf

#include "dynamic/background_planes.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>

namespace msf {
namespace {

// Points with normal . p = distance.
struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float distance_m = 0;
};

float Tolerance(float z_m, const PlaneOptions& options) {
  return static_cast<float>(options.tolerance_m + options.tolerance_per_m2 * z_m * z_m);
}

bool Lies(const Eigen::Vector3f& p, const Plane& plane, const PlaneOptions& options) {
  return p.z() > 0 && std::abs(plane.normal.dot(p) - plane.distance_m) < Tolerance(p.z(), options);
}

// Normal of the surface around a block; zero where it is not whole.
Eigen::Vector3f NormalAt(const CoarseDepth& depth, const BlockRays& rays, int row, int col,
                         int reach) {
  if (row < reach || col < reach || row + reach >= rays.rows() || col + reach >= rays.cols())
    return Eigen::Vector3f::Zero();
  const Eigen::Vector3f left = rays.Point(depth, row, col - reach),
                        right = rays.Point(depth, row, col + reach),
                        up = rays.Point(depth, row - reach, col),
                        down = rays.Point(depth, row + reach, col);
  if (left.z() <= 0 || right.z() <= 0 || up.z() <= 0 || down.z() <= 0)
    return Eigen::Vector3f::Zero();
  return (right - left).cross(down - up).normalized();
}

std::vector<Eigen::Vector3f> Inliers(const std::vector<Eigen::Vector3f>& points, const Plane& plane,
                                     const PlaneOptions& options) {
  std::vector<Eigen::Vector3f> inliers;
  for (const Eigen::Vector3f& p : points) {
    if (Lies(p, plane, options)) inliers.push_back(p);
  }
  return inliers;
}

// Least squares.
Plane Fit(const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& p : points) mean += p;
  mean /= static_cast<float>(points.size());
  Eigen::Matrix3f spread = Eigen::Matrix3f::Zero();
  for (const Eigen::Vector3f& p : points) spread += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(spread);
  const Eigen::Vector3f normal = solver.eigenvectors().col(0);
  return {normal, normal.dot(mean)};
}

struct Sample {
  Eigen::Vector3f point, normal;
};

// Every other block.
std::vector<Sample> SamplesOutside(const CoarseDepth& depth, const BlockRays& rays,
                                   const cv::Mat1b& excluded) {
  constexpr int kStep = 2, kReach = 4;
  std::vector<Sample> samples;
  for (int r = 0; r < rays.rows(); r += kStep) {
    for (int c = 0; c < rays.cols(); c += kStep) {
      const Eigen::Vector3f p = rays.Point(depth, r, c);
      if (p.z() > 0 && excluded(r, c) == 0)
        samples.push_back({p, NormalAt(depth, rays, r, c, kReach)});
    }
  }
  return samples;
}

std::optional<Plane> BestPlane(const std::vector<Sample>& samples,
                               const std::vector<Eigen::Vector3f>& points,
                               const PlaneOptions& options, std::mt19937_64& random) {
  size_t most = 0;
  Plane best;
  for (int k = 0; k < options.hypotheses; ++k) {
    const Sample& sample = samples[random() % samples.size()];
    if (sample.normal.isZero()) continue;
    const Plane plane{sample.normal, sample.normal.dot(sample.point)};
    size_t count = 0;
    for (const Eigen::Vector3f& p : points) count += Lies(p, plane, options);
    if (count <= most) continue;
    most = count;
    best = plane;
  }
  const auto least = static_cast<size_t>(options.min_share * static_cast<double>(points.size()));
  if (most < std::max<size_t>(3, least / 2)) return std::nullopt;
  best = Fit(Inliers(points, best, options));
  const std::vector<Eigen::Vector3f> inliers = Inliers(points, best, options);
  if (inliers.size() < std::max<size_t>(3, least)) return std::nullopt;
  return Fit(inliers);
}

// Blocks on the plane whose surface faces its way.
cv::Mat1b BlocksOn(const Plane& plane, const CoarseDepth& depth, const BlockRays& rays,
                   const PlaneOptions& options) {
  constexpr int kReach = 2;
  constexpr float kFacing = 0.8f;  // cosine
  cv::Mat1b on_plane(rays.rows(), rays.cols(), static_cast<uint8_t>(0));
  for (int r = 0; r < rays.rows(); ++r) {
    for (int c = 0; c < rays.cols(); ++c) {
      if (!Lies(rays.Point(depth, r, c), plane, options)) continue;
      if (std::abs(NormalAt(depth, rays, r, c, kReach).dot(plane.normal)) > kFacing)
        on_plane(r, c) = 255;
    }
  }
  return on_plane;
}

// A back may be flat, and fill a box.
bool IsPartOfObject(const cv::Mat1b& on_plane, const cv::Mat1b& in_mask) {
  constexpr double kMost = 0.8;
  return cv::countNonZero(on_plane & in_mask) > kMost * cv::countNonZero(on_plane);
}

// Drops the pieces that are excluded as a whole or almost so: a box that is a little too small
// leaves an edge of its object outside.
void KeepPiecesFromOutside(const cv::Mat1b& excluded, cv::Mat1b& on_plane) {
  constexpr int kMostInside = 3;  // times what is outside
  cv::Mat1i pieces;
  const int count = cv::connectedComponents(on_plane, pieces, 4, CV_32S);
  std::vector<int> inside(count, 0), outside(count, 0);
  for (int r = 0; r < pieces.rows; ++r) {
    for (int c = 0; c < pieces.cols; ++c) ++(excluded(r, c) != 0 ? inside : outside)[pieces(r, c)];
  }
  for (int r = 0; r < pieces.rows; ++r) {
    for (int c = 0; c < pieces.cols; ++c) {
      const int piece = pieces(r, c);
      if (inside[piece] > kMostInside * outside[piece]) on_plane(r, c) = 0;
    }
  }
}

}  // namespace

cv::Mat1b FindPlaneBlocks(const CoarseDepth& depth, const BlockRays& rays,
                          const cv::Mat1b& excluded, const cv::Mat1b& in_mask,
                          const PlaneOptions& options, uint64_t seed) {
  cv::Mat1b on_plane(rays.rows(), rays.cols(), static_cast<uint8_t>(0));
  std::mt19937_64 random(seed);
  const std::vector<Sample> samples = SamplesOutside(depth, rays, excluded);
  std::vector<Eigen::Vector3f> points;
  points.reserve(samples.size());
  for (const Sample& sample : samples) points.push_back(sample.point);
  for (int k = 0; k < options.max_planes && !points.empty(); ++k) {
    const std::optional<Plane> plane = BestPlane(samples, points, options, random);
    if (!plane) break;
    cv::Mat1b blocks = BlocksOn(*plane, depth, rays, options);
    KeepPiecesFromOutside(excluded, blocks);
    if (!IsPartOfObject(blocks, in_mask)) on_plane |= blocks;
    std::erase_if(points, [&](const Eigen::Vector3f& p) { return Lies(p, *plane, options); });
  }
  return on_plane;
}

}  // namespace msf

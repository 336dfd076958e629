// How far an observation lies from where a point projects: the residual that pose optimisation and
// bundle adjustment share.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/rigid3d.h"
#include "sensor/camera.h"

namespace msf {

// One sighting of a point. The residual is (u, v) or, with depth, (u, v, d) where d = bf / z is the
// disparity of a virtual stereo pair. Disparity stands in for the usual u_R = u - d because its
// error comes from the depth sensor alone and so is independent of the error of u: each gets its
// own variance and the covariance stays diagonal.
struct ImageObservation {
  Eigen::Vector2d uv_px = Eigen::Vector2d::Zero();  // undistorted
  double disparity_px = -1;                         // bf / measured depth; <= 0: no depth
  double inv_sigma2 = 1;                            // of u and of v, 1/px^2
  double inv_knee_disparity = 0;                    // see DisparityCost
  double inv_sigma2_disparity = 1;                  // of the disparity, 1/px^2
  double weight = 1;                                // static probability, [0, 1]; 0: ignored

  bool HasDepth() const { return disparity_px > 0; }
  // False for what no solver should touch: weight 0, or a value that is no finite number.
  bool Usable() const {
    return weight > 0 && std::isfinite(weight) && uv_px.allFinite() &&
           std::isfinite(disparity_px) && inv_sigma2 > 0 && std::isfinite(inv_sigma2) &&
           inv_sigma2_disparity >= 0 && std::isfinite(inv_sigma2_disparity);
  }
};

// Limits between inliers and outliers: 95 % quantiles of chi^2 with 2 and 3 degrees of freedom.
struct Chi2Gates {
  double two = 5.991;
  double three = 7.815;

  double For(const ImageObservation& observation) const {
    return observation.HasDepth() ? three : two;
  }
};

// A point nearer to the camera plane than this cannot have been seen, m. It is no inlier, and in
// costs it counts as if it stood at this depth: the cost stays finite and continuous, so that a
// wrong match on the camera plane neither holds a pose in place nor gains by slipping behind the
// camera.
inline constexpr double kMinProjectionDepth_m = 0.1;

// Predicted minus measured (u, v, d) in px; d is 0 without depth.
inline Eigen::Vector3d ReprojectionResidual(const Camera& camera, const Eigen::Vector3d& p_c,
                                            const ImageObservation& observation) {
  const double inv_z = 1 / std::max(p_c.z(), kMinProjectionDepth_m);
  return {camera.fx * p_c.x() * inv_z + camera.cx - observation.uv_px.x(),
          camera.fy * p_c.y() * inv_z + camera.cy - observation.uv_px.y(),
          observation.HasDepth() ? camera.bf * inv_z - observation.disparity_px : 0};
}

// Derivative of the residual by the point, px/m: rows (a, 0, c), (0, b, d), (0, 0, e).
// (e belongs to observations with depth only).
struct ReprojectionJacobian {
  double a, b, c, d, e;

  ReprojectionJacobian(const Camera& camera, const Eigen::Vector3d& p_c) {
    const double inv_z = 1 / std::max(p_c.z(), kMinProjectionDepth_m);
    const double by_z = p_c.z() > kMinProjectionDepth_m ? -inv_z * inv_z : 0;
    a = camera.fx * inv_z;
    b = camera.fy * inv_z;
    c = camera.fx * p_c.x() * by_z;
    d = camera.fy * p_c.y() * by_z;
    e = camera.bf * by_z;
  }
  Eigen::Matrix3d Matrix() const {
    return (Eigen::Matrix3d() << a, 0, c, 0, b, d, 0, 0, e).finished();
  }
};

// Geman and McClure's kernel on the squared disparity error s (over variance): s / (1 + s *
// inv_knee). A depth sampled across an edge is wrong by far more than the sensor's noise while the
// position in the image is right: its disparity then costs at most 1 / inv_knee and pulls no more,
// and the observation goes on as one without depth. inv_knee = 0 is plain least squares.
inline double DisparityCost(double squared_error, double inv_knee) {
  return squared_error / (1 + squared_error * inv_knee);
}
// Its derivative, the factor on the information of the disparity.
inline double DisparityWeight(double squared_error, double inv_knee) {
  const double ratio = 1 / (1 + squared_error * inv_knee);
  return ratio * ratio;
}

// Squared residual over variance.
inline double ResidualChi2(const Eigen::Vector3d& residual, const ImageObservation& observation) {
  const double disparity_error = observation.inv_sigma2_disparity * residual.z() * residual.z();
  return observation.inv_sigma2 * residual.head<2>().squaredNorm() +
         DisparityCost(disparity_error, observation.inv_knee_disparity);
}

// The same for a point; infinite when it lies at or behind the camera plane.
inline double ReprojectionChi2(const Camera& camera, const Eigen::Vector3d& p_c,
                               const ImageObservation& observation) {
  if (!(p_c.z() >= kMinProjectionDepth_m)) return std::numeric_limits<double>::infinity();
  return ResidualChi2(ReprojectionResidual(camera, p_c, observation), observation);
}

// Huber's kernel on chi^2 with its knee at `gate`: rho(s) = s below, 2 sqrt(gate s) - gate above.
inline double HuberCost(double chi2, double gate) {
  return chi2 <= gate ? chi2 : 2 * std::sqrt(gate * chi2) - gate;
}
// rho'(s), the factor on the information of an observation.
inline double HuberWeight(double chi2, double gate) {
  return chi2 <= gate ? 1 : std::sqrt(gate / chi2);
}

// weight * rho(chi^2), or weight * chi^2 when the kernel is off.
inline double ObservationCost(const ImageObservation& observation, double chi2, double gate,
                              bool robust) {
  return observation.weight * (robust ? HuberCost(chi2, gate) : chi2);
}

// How one observation pulls on its point in camera coordinates: cost, Gauss-Newton gradient J^T W r
// and information J^T W J (robust and static weight included).
struct PointPull {
  double cost = 0;
  Eigen::Vector3d gradient;
  Eigen::Matrix3d information;
};

inline PointPull PullOnPoint(const Camera& camera, const Eigen::Vector3d& p_c,
                             const ImageObservation& observation, double gate, bool robust) {
  const Eigen::Vector3d r = ReprojectionResidual(camera, p_c, observation);
  const double chi2 = ResidualChi2(r, observation);
  const double scale = observation.weight * (robust ? HuberWeight(chi2, gate) : 1);
  const double w = scale * observation.inv_sigma2;
  const double disparity_error = observation.inv_sigma2_disparity * r.z() * r.z();
  const double w_d = observation.HasDepth()
                         ? scale * observation.inv_sigma2_disparity *
                               DisparityWeight(disparity_error, observation.inv_knee_disparity)
                         : 0;
  const auto [a, b, c, d, e] = ReprojectionJacobian(camera, p_c);
  const double ac = w * a * c, bd = w * b * d;
  PointPull pull;
  pull.cost = ObservationCost(observation, chi2, gate, robust);
  pull.gradient << w * a * r.x(), w * b * r.y(), w * (c * r.x() + d * r.y()) + w_d * e * r.z();
  pull.information << w * a * a, 0, ac, 0, w * b * b, bd, ac, bd, w * (c * c + d * d) + w_d * e * e;
  return pull;
}

}  // namespace msf

// Random changes of a training picture that leave its geometry alone.
#pragma once

#include <opencv2/core.hpp>
#include <random>

namespace msf {

// Scales hue, saturation and value by random factors in 1 - x .. 1 + x. `pixels`: BGR, 8 bit.
void ChangeColours(cv::Mat& pixels, double hue, double saturation, double value,
                   std::mt19937_64& random);

// Motion blur of 3 to 11 pixels in a random direction, or a Gaussian of sigma 0.5 to 1.5 pixels.
void Blur(cv::Mat& pixels, std::mt19937_64& random);

}  // namespace msf

// Procedural pictures for surfaces: 8-bit BGR, full of corners that differ from place to place.
// Sizes are in texels; `random` decides everything that is left open.
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "simulation/random.h"

namespace msf {

// Room surfaces. `base` is the dominant colour.
cv::Mat PaintPlaster(cv::Size size, const cv::Scalar& base, Random random);
cv::Mat PaintWallpaper(cv::Size size, const cv::Scalar& base, Random random);
cv::Mat PaintParquet(cv::Size size, Random random);
cv::Mat PaintCarpet(cv::Size size, const cv::Scalar& base, Random random);
cv::Mat PaintCeilingPanels(cv::Size size, Random random);
cv::Mat PaintRug(cv::Size size, Random random);

// Furniture and materials.
cv::Mat PaintWood(cv::Size size, const cv::Scalar& base, Random random);
cv::Mat PaintMetal(cv::Size size, const cv::Scalar& base, Random random);
cv::Mat PaintFabric(cv::Size size, const cv::Scalar& base, Random random);
cv::Mat PaintDoor(cv::Size size, const cv::Scalar& base, Random random);
cv::Mat PaintCabinetFront(cv::Size size, const cv::Scalar& base, Random random);
cv::Mat PaintLeaves(cv::Size size, Random random);

// Things to look at.
cv::Mat PaintPoster(cv::Size size, Random random);
cv::Mat PaintLandscape(cv::Size size, Random random);
cv::Mat PaintPage(cv::Size size, Random random);
cv::Mat PaintScreen(cv::Size size, Random random);
cv::Mat PaintKeyboard(cv::Size size, Random random);
cv::Mat PaintCarton(cv::Size size, Random random);
cv::Mat PaintBookCover(cv::Size size, Random random);
cv::Mat PaintBookSpine(cv::Size size, Random random);
cv::Mat PaintBall(cv::Size size, Random random);

// People; the middle of the picture is the front.
cv::Mat PaintHead(cv::Size size, const cv::Scalar& skin, const cv::Scalar& hair, Random random);
cv::Mat PaintShirt(cv::Size size, const cv::Scalar& base, Random random);
cv::Mat PaintTrousers(cv::Size size, const cv::Scalar& base, Random random);

// A saturated colour, and a colour near `base`.
cv::Scalar VividColor(Random& random);
cv::Scalar NearbyColor(const cv::Scalar& base, double spread, Random& random);
// Adds soft noise of the given contrast (standard deviation, levels) at a feature size of `texels`.
void AddMottle(cv::Mat& picture, double contrast, double texels, Random& random);
// Fills `area` with lines of words of about `letter` texels height.
void DrawText(cv::Mat& picture, const cv::Rect& area, double letter, const cv::Scalar& ink,
              Random& random);

}  // namespace msf

// A small writer of scalable pictures (SVG 1.1): lines, boxes and text in pixels from the upper
// left corner.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace msf {

struct Color {
  uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Color&, const Color&) = default;
};

struct Box {
  double left = 0, top = 0, width = 0, height = 0;
  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

struct Stroke {
  Color color;
  double width = 1;
  const char* dashes = "";  // e.g. "4 3": lengths on and off; empty for a full line
};

struct TextStyle {
  double size = 12;
  const char* anchor = "start";  // which part of the text is at the point: start, middle or end
  Color color = {0x33, 0x33, 0x33};
  bool bold = false;
  bool upwards = false;  // turned by 90 degrees to the left
};

class SvgCanvas {
 public:
  SvgCanvas(double width, double height);

  void Line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Stroke& stroke);
  void Polyline(std::span<const Eigen::Vector2d> points, const Stroke& stroke);
  // Only what lies inside the box that DefineClip() gave the number.
  void ClippedPolyline(std::span<const Eigen::Vector2d> points, const Stroke& stroke, int clip);
  int DefineClip(const Box& box);
  void FillBox(const Box& box, Color fill);
  // The area that the points enclose, see-through by `opacity` < 1; clipped like a polyline.
  void FillClippedPolygon(std::span<const Eigen::Vector2d> points, Color fill, double opacity,
                          int clip);
  // A picture, stretched to the box; `address` is usually a "data:" one, so that it is in the file.
  void Image(const Box& box, const std::string& address);
  void FillDisc(const Eigen::Vector2d& centre, double radius, Color fill);
  // `at` is on the text's base line. Any UTF-8 text; what XML reserves is escaped.
  void Text(const Eigen::Vector2d& at, const std::string& text, const TextStyle& style = {});

  // The finished file.
  std::string ToString() const;

 private:
  void AddPolyline(std::span<const Eigen::Vector2d> points, const std::string& attributes);

  double width_, height_;
  int num_clips_ = 0;
  std::string body_;
};

}  // namespace msf

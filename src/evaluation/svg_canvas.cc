#include "evaluation/svg_canvas.h"

#include <fmt/format.h>

#include "util/markup.h"

namespace msf {
namespace {

std::string Hex(Color c) { return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b); }

std::string Attributes(const Stroke& stroke) {
  std::string text =
      fmt::format(R"(stroke="{}" stroke-width="{:g}")", Hex(stroke.color), stroke.width);
  if (*stroke.dashes != '\0') text += fmt::format(R"( stroke-dasharray="{}")", stroke.dashes);
  return text;
}

}  // namespace

SvgCanvas::SvgCanvas(double width, double height) : width_(width), height_(height) {
  FillBox({0, 0, width, height}, {0xff, 0xff, 0xff});
}

void SvgCanvas::Line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Stroke& stroke) {
  body_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n",
                       from.x(), from.y(), to.x(), to.y(), Attributes(stroke));
}

void SvgCanvas::AddPolyline(std::span<const Eigen::Vector2d> points,
                            const std::string& attributes) {
  if (points.empty()) return;
  body_ += "<polyline fill=\"none\" stroke-linejoin=\"round\" " + attributes + " points=\"";
  for (const Eigen::Vector2d& p : points) body_ += fmt::format("{:.1f},{:.1f} ", p.x(), p.y());
  body_.back() = '"';
  body_ += "/>\n";
}

void SvgCanvas::Polyline(std::span<const Eigen::Vector2d> points, const Stroke& stroke) {
  AddPolyline(points, Attributes(stroke));
}

void SvgCanvas::ClippedPolyline(std::span<const Eigen::Vector2d> points, const Stroke& stroke,
                                int clip) {
  AddPolyline(points, fmt::format("clip-path=\"url(#clip{})\" ", clip) + Attributes(stroke));
}

int SvgCanvas::DefineClip(const Box& box) {
  const int clip = num_clips_++;
  body_ += fmt::format(
      "<clipPath id=\"clip{}\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
      "height=\"{:.1f}\"/></clipPath>\n",
      clip, box.left, box.top, box.width, box.height);
  return clip;
}

void SvgCanvas::FillBox(const Box& box, Color fill) {
  body_ += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n",
      box.left, box.top, box.width, box.height, Hex(fill));
}

void SvgCanvas::FillClippedPolygon(std::span<const Eigen::Vector2d> points, Color fill,
                                   double opacity, int clip) {
  if (points.empty()) return;
  body_ +=
      fmt::format("<polygon clip-path=\"url(#clip{})\" fill=\"{}\" fill-opacity=\"{:g}\" points=\"",
                  clip, Hex(fill), opacity);
  for (const Eigen::Vector2d& p : points) body_ += fmt::format("{:.1f},{:.1f} ", p.x(), p.y());
  body_.back() = '"';
  body_ += "/>\n";
}

void SvgCanvas::Image(const Box& box, const std::string& address) {
  body_ += fmt::format(
      "<image x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
      "preserveAspectRatio=\"none\" href=\"{}\"/>\n",
      box.left, box.top, box.width, box.height, EscapeMarkup(address));
}

void SvgCanvas::FillDisc(const Eigen::Vector2d& centre, double radius, Color fill) {
  body_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" fill=\"{}\"/>\n", centre.x(),
                       centre.y(), radius, Hex(fill));
}

void SvgCanvas::Text(const Eigen::Vector2d& at, const std::string& text, const TextStyle& style) {
  const std::string turn =
      style.upwards ? fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", at.x(), at.y()) : "";
  body_ += fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{:g}\" text-anchor=\"{}\" "
      "fill=\"{}\"{}{}>{}</text>\n",
      at.x(), at.y(), style.size, style.anchor, Hex(style.color),
      style.bold ? " font-weight=\"bold\"" : "", turn, EscapeMarkup(text));
}

std::string SvgCanvas::ToString() const {
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" "
             "viewBox=\"0 0 {0:g} {1:g}\" "
             "font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\">\n",
             width_, height_) +
         body_ + "</svg>\n";
}

}  // namespace msf

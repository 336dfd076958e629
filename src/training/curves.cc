#include "training/curves.h"

#include <algorithm>
#include <sstream>
#include <string>

#include "training/trainer.h"
#include "util/atomic_file.h"

namespace msf {

namespace {

struct Curve {
  const char* name;
  const char* colour;
  double EpochRecord::*value;
};

const std::vector<Curve> kLosses = {
    {"box loss", "#1f77b4", &EpochRecord::box_loss},
    {"class loss", "#ff7f0e", &EpochRecord::class_loss},
    {"distribution loss", "#2ca02c", &EpochRecord::distribution_loss},
    {"imitation", "#9467bd", &EpochRecord::imitation_loss},
    {"features", "#17becf", &EpochRecord::feature_loss}};
const std::vector<Curve> kPrecisions = {{"mAP50", "#d62728", &EpochRecord::map50},
                                        {"mAP50-95", "#8c564b", &EpochRecord::map50_95}};

// One panel: axes with the largest value, the curves and their names.
void DrawPanel(std::ostream& svg, const std::vector<Curve>& curves,
               const std::vector<EpochRecord>& records, double left) {
  constexpr double kWidth = 360.0, kHeight = 240.0, kTop = 30.0;
  double most = 1e-6;
  for (const Curve& curve : curves) {
    for (const EpochRecord& record : records) most = std::max(most, record.*curve.value);
  }
  svg << "<rect x='" << left << "' y='" << kTop << "' width='" << kWidth << "' height='" << kHeight
      << "' fill='none' stroke='#888'/>\n<text x='" << left << "' y='" << kTop - 6 << "'>" << most
      << "</text>\n<text x='" << left + kWidth - 60 << "' y='" << kTop + kHeight + 16 << "'>epoch "
      << records.size() << "</text>\n";
  double line = kTop + 16;
  for (const Curve& curve : curves) {
    svg << "<polyline fill='none' stroke='" << curve.colour << "' stroke-width='2' points='";
    for (size_t i = 0; i < records.size(); ++i) {
      const double x =
          left + kWidth * static_cast<double>(i + 1) / static_cast<double>(records.size());
      svg << x << "," << kTop + kHeight * (1.0 - records[i].*curve.value / most) << " ";
    }
    svg << "'/>\n<text x='" << left + kWidth - 130 << "' y='" << line << "' fill='" << curve.colour
        << "'>" << curve.name << " " << records.back().*curve.value << "</text>\n";
    line += 16;
  }
}

}  // namespace

Status WriteCurves(const std::filesystem::path& directory,
                   const std::vector<EpochRecord>& records) {
  std::ostringstream csv;
  csv << "epoch,learning_rate,box_loss,class_loss,distribution_loss,imitation_loss,feature_loss,"
         "map50,"
         "map50_95\n";
  for (const EpochRecord& r : records) {
    csv << r.epoch << "," << r.learning_rate << "," << r.box_loss << "," << r.class_loss << ","
        << r.distribution_loss << "," << r.imitation_loss << "," << r.feature_loss << "," << r.map50
        << "," << r.map50_95 << "\n";
  }
  MSF_RETURN_IF_ERROR(WriteFileAtomically(directory / "curves.csv", csv.str()));
  if (records.empty()) return Status::Ok();
  std::ostringstream svg;
  svg << "<svg xmlns='http://www.w3.org/2000/svg' width='820' height='300' "
         "font-family='sans-serif' font-size='12'>\n"
      << "<rect width='100%' height='100%' fill='white'/>\n";
  DrawPanel(svg, kLosses, records, 20.0);
  DrawPanel(svg, kPrecisions, records, 430.0);
  svg << "</svg>\n";
  return WriteFileAtomically(directory / "curves.svg", svg.str());
}

}  // namespace msf

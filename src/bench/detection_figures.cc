// Figure 4: what the detectors find.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/child_process.h"
#include "bench/figures.h"
#include "bench/thumbnail.h"
#include "evaluation/svg_canvas.h"
#include "io/image_reader.h"
#include "io/tum_dataset.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModels[] = {"yolov8n_voc.onnx", "yolov8n_msf_voc.onnx"};
constexpr const char* kModelNames[] = {"YOLOv8n", "YOLOv8n + MSFConv"};
constexpr char kPhotographs[] = " They may show real people: think before passing them on.";
constexpr int kPictures = 3, kWidth_px = 392;
constexpr double kGap = 8, kTop = 44, kRowTitle = 26, kLimit_s = 300;
constexpr Color kPerson = {0xe8, 0x2c, 0x2c}, kThing = {0x1f, 0x6f, 0xd0};

// File stems of pictures spread over the sequence. Their folder, too.
std::vector<std::string> ChoosePictures(const TumDataset& dataset) {
  std::vector<std::string> stems;
  for (size_t i = 0; i < kPictures; ++i)
    stems.push_back(dataset.files((2 * i + 1) * dataset.size() / (2 * kPictures)).color.stem());
  return stems;
}

// What a model finds in the pictures, as `msf-slam detect --json` tells it; null when it does not.
nlohmann::json Detect(const fs::path& folder, const char* model, const fs::path& pictures,
                      const std::vector<std::string>& stems) {
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  std::ofstream list(folder / "list.txt");
  for (const std::string& stem : stems) list << stem << "\n";
  list.close();
  const fs::path found = folder / "found.json";
  const ProcessEnd end =
      RunProcess({{ThisProgram().string(), "detect", pictures.string(), "--model", model, "--list",
                   (folder / "list.txt").string(), "--json", found.string()},
                  folder / "log.txt",
                  kLimit_s});
  std::ifstream stream(found);
  if (!end.ok() || !stream) return nullptr;
  return nlohmann::json::parse(stream, nullptr, false);
}

// The picture with its boxes; the names are drawn at the size of the report, so that they can be
// read.
void DrawPicture(SvgCanvas& canvas, const Eigen::Vector2d& at, const cv::Mat& picture,
                 const nlohmann::json& objects) {
  const double scale = static_cast<double>(kWidth_px) / picture.cols;
  canvas.Image({at.x(), at.y(), kWidth_px, scale * picture.rows},
               ThumbnailAddress(picture, kWidth_px));
  for (const nlohmann::json& object : objects) {
    const auto name = object.at(0).get<std::string>();
    const Color color = name == "person" ? kPerson : kThing;
    const auto corner = [&](size_t x, size_t y) {
      return Eigen::Vector2d(at.x() + scale * object.at(x).get<double>(),
                             at.y() + scale * object.at(y).get<double>());
    };
    const Eigen::Vector2d first = corner(2, 3), last = corner(4, 5);
    const std::vector<Eigen::Vector2d> box = {
        first, {last.x(), first.y()}, last, {first.x(), last.y()}, first};
    canvas.Polyline(box, {color, 2});
    const std::string label = fmt::format("{} {:.2f}", name, object.at(1).get<double>());
    const double width = 6.6 * static_cast<double>(label.size()) + 6;
    const double left = std::min(first.x(), at.x() + kWidth_px - width);
    canvas.FillBox({left, first.y(), width, 15}, color);
    canvas.Text({left + 3, first.y() + 12}, label, {.size = 11, .color = {255, 255, 255}});
  }
}

std::string DrawSequence(const fs::path& work, const std::string& title, const fs::path& pictures,
                         const std::string& extension, const std::vector<std::string>& stems) {
  constexpr double kHeight = kWidth_px * 0.75;
  const double row = kRowTitle + kHeight + kGap;
  SvgCanvas canvas(kPictures * (kWidth_px + kGap) + kGap, kTop + row * std::size(kModels));
  canvas.Text({kGap, 28}, title, {.size = 15, .bold = true});
  ImageReader reader;
  for (size_t m = 0; m < std::size(kModels); ++m) {
    const double top = kTop + row * static_cast<double>(m);
    canvas.Text({kGap, top + 16}, kModelNames[m], {.size = 13});
    const nlohmann::json found = Detect(work / kModels[m], kModels[m], pictures, stems);
    if (!found.is_object()) return "";
    for (size_t i = 0; i < stems.size(); ++i) {
      const StatusOr<cv::Mat> picture = reader.ReadColor(pictures / (stems[i] + extension));
      if (!picture.ok() || !found.contains(stems[i])) return "";
      const double left = kGap + static_cast<double>(i) * (kWidth_px + kGap);
      DrawPicture(canvas, {left, top + kRowTitle}, *picture, found[stems[i]]);
    }
  }
  return canvas.ToString();
}

}  // namespace

std::vector<Figure> DetectionFigures(const fs::path& out, const BenchResults& results) {
  std::vector<Figure> figures;
  const SuiteVariant* ours = results.suite.FindVariant(results.suite.ours);
  if (ours == nullptr || ours->detector == "none" || ours->dynamic == "off") return figures;
  for (const SuiteSequence& sequence : results.suite.sequences) {
    if (static_cast<int>(figures.size()) >= results.suite.picture_sequences) break;
    const std::string folder = results.plan.FolderOf(sequence.name);
    // Where nobody is, there is nothing to show.
    if (folder.empty() || sequence.without_actors) continue;
    const StatusOr<TumDataset> dataset = TumDataset::Open(folder, "tum_fr3");
    if (!dataset.ok() || dataset->size() < kPictures) continue;
    const std::string title = "Figure 4: detections in " + sequence.name;
    const fs::path work = out / "detections" / sequence.name;
    const fs::path first = dataset->files(0).color;
    const std::string svg =
        DrawSequence(work, title, first.parent_path(), first.extension(), ChoosePictures(*dataset));
    std::error_code ignored;
    fs::remove_all(out / "detections", ignored);
    if (svg.empty()) continue;
    figures.push_back({"figure4_" + sequence.name, "", title,
                       fmt::format("Pictures spread over the sequence; {} and {}.{}", kModels[0],
                                   kModels[1], sequence.scenario.empty() ? kPhotographs : ""),
                       svg});
  }
  return figures;
}

}  // namespace msf

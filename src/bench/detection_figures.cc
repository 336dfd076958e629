// Figure 4: what the detectors find.
#include <fmt/format.h>

#include <fstream>

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
constexpr int kPictures = 4, kWidth_px = 232;
constexpr double kHeight_px = 174, kGap = 8, kTop = 44, kRowTitle = 26, kLimit_s = 300;

// File stems of pictures spread over the sequence. Their folder, too.
std::vector<std::string> ChoosePictures(const TumDataset& dataset) {
  std::vector<std::string> stems;
  for (size_t i = 0; i < kPictures; ++i)
    stems.push_back(dataset.files((2 * i + 1) * dataset.size() / (2 * kPictures)).color.stem());
  return stems;
}

// Draws the boxes that a model finds into copies of the pictures; false when that did not work.
bool Detect(const fs::path& folder, const char* model, const fs::path& pictures,
            const std::vector<std::string>& stems) {
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  std::ofstream list(folder / "list.txt");
  for (const std::string& stem : stems) list << stem << "\n";
  list.close();
  return RunProcess({{ThisProgram().string(), "detect", pictures.string(), "--model", model,
                      "--list", (folder / "list.txt").string(), "--overlay", folder.string()},
                     folder / "log.txt",
                     kLimit_s})
      .ok();
}

std::string DrawSequence(const fs::path& work, const std::string& title, const fs::path& pictures,
                         const std::vector<std::string>& stems) {
  const double row = kRowTitle + kHeight_px + kGap;
  SvgCanvas canvas(kPictures * (kWidth_px + kGap) + kGap, kTop + row * std::size(kModels));
  canvas.Text({kGap, 28}, title, {.size = 15, .bold = true});
  ImageReader reader;
  for (size_t m = 0; m < std::size(kModels); ++m) {
    const double top = kTop + row * static_cast<double>(m);
    canvas.Text({kGap, top + 16}, kModelNames[m], {.size = 13});
    if (!Detect(work / kModels[m], kModels[m], pictures, stems)) return "";
    for (size_t i = 0; i < stems.size(); ++i) {
      const StatusOr<cv::Mat> picture = reader.ReadColor(work / kModels[m] / (stems[i] + ".png"));
      if (!picture.ok()) return "";
      canvas.Image({kGap + static_cast<double>(i) * (kWidth_px + kGap), top + kRowTitle, kWidth_px,
                    kHeight_px},
                   ThumbnailAddress(*picture, 2 * kWidth_px));
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
    const std::string svg =
        DrawSequence(work, title, dataset->files(0).color.parent_path(), ChoosePictures(*dataset));
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

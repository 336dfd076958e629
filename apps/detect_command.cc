// msf-slam detect: finds objects in images.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/arguments.h"
#include "apps/detector_arguments.h"
#include "apps/image_list.h"
#include "apps/overlay.h"
#include "evaluation/json_text.h"
#include "io/image_reader.h"
#include "io/png_encoder.h"
#include "util/atomic_file.h"
#include "util/progress.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

struct DetectArguments {
  DetectorArguments detector;
  fs::path source, list_file, json_file, overlay_folder;
};

// [class name, score, x0, y0, x1, y1], numbers short enough to read.
nlohmann::json RowOf(const Detection& d, const std::vector<std::string>& names) {
  const auto rounded = [](float x, double step) { return std::round(x / step) * step; };
  const auto pixels = [&](float x) {
    return nlohmann::json::parse(fmt::format("{:.2f}", rounded(x, 0.01)));
  };
  return {names[static_cast<size_t>(d.class_id)],
          nlohmann::json::parse(fmt::format("{:.5f}", d.score)),
          pixels(d.box.x0),
          pixels(d.box.y0),
          pixels(d.box.x1),
          pixels(d.box.y1)};
}

void PrintRows(const std::string& stem, const Detections& detections,
               const std::vector<std::string>& names) {
  for (const Detection& d : detections.objects) {
    std::cout << fmt::format("{} {} {:.3f} {:.1f} {:.1f} {:.1f} {:.1f}\n", stem,
                             names[static_cast<size_t>(d.class_id)], d.score, d.box.x0, d.box.y0,
                             d.box.x1, d.box.y1);
  }
}

fs::path OverlayOf(const fs::path& image, const fs::path& folder) {
  return folder / (image.stem().string() + ".png");
}

// Results must take the place of nothing that they are made from.
void CheckTargets(const DetectArguments& arguments, const std::vector<fs::path>& images) {
  std::set<fs::path> inputs = {ResolvePath(arguments.list_file)};
  for (const fs::path& image : images) inputs.insert(ResolvePath(image));
  const auto check = [&inputs](const fs::path& target, const char* option) {
    if (!target.empty() && inputs.contains(ResolvePath(target))) {
      throw CommandFailure(fmt::format(
          "{}: would be overwritten, but is read; give {} another place", target.string(), option));
    }
  };
  check(arguments.json_file, "--json");
  if (arguments.overlay_folder.empty()) return;
  for (const fs::path& image : images)
    check(OverlayOf(image, arguments.overlay_folder), "--overlay");
}

// Finds, prints and draws what one image shows and adds it to `json`. An error: the image is of no
// use.
Status DetectIn(const fs::path& file, const DetectArguments& arguments, Detector& detector,
                ImageReader& reader, nlohmann::json& json) {
  const StatusOr<cv::Mat> image = reader.ReadColor(file);
  if (!image.ok()) return image.status();
  const StatusOr<Detections> detections = detector.DetectInImage(*image);
  if (!detections.ok()) return Status::Error(file.string() + ": " + detections.message());
  const std::string stem = file.stem().string();
  if (arguments.json_file.empty()) PrintRows(stem, *detections, detector.class_names());
  json[stem] = nlohmann::json::array();
  for (const Detection& d : detections->objects)
    json[stem].push_back(RowOf(d, detector.class_names()));
  if (!arguments.overlay_folder.empty()) {
    const cv::Mat drawn = DrawDetections(*image, detections->objects, detector.class_names());
    Require(WriteFileAtomically(OverlayOf(file, arguments.overlay_folder), EncodePng(drawn)));
  }
  return Status::Ok();
}

void Detect(DetectArguments& arguments) {
  const std::vector<fs::path> images = Require(FindImages(arguments.source, arguments.list_file));
  Require(ImagesByStem(images));
  CheckTargets(arguments, images);
  const std::unique_ptr<Detector> detector = arguments.detector.Make();
  std::cerr << detector->description() << "\n";
  if (!arguments.overlay_folder.empty()) MakeFolder(arguments.overlay_folder);
  nlohmann::json json = nlohmann::json::object();
  ImageReader reader;
  int num_failed = 0;
  Progress progress("detect", "images", static_cast<int>(images.size()));
  for (size_t i = 0; i < images.size(); ++i) {
    const Status status = DetectIn(images[i], arguments, *detector, reader, json);
    if (!status.ok()) {
      ++num_failed;
      std::cerr << "\nmsf-slam: " << status.message() << "\n";
    }
    progress.Update(static_cast<int>(i) + 1);
  }
  if (!arguments.json_file.empty())
    Require(WriteFileAtomically(arguments.json_file, JsonText(json, -1)));
  if (num_failed > 0) {
    throw CommandFailure(fmt::format("{} of {} images could not be used; the lines above say why",
                                     num_failed, images.size()));
  }
}

}  // namespace

void AddDetectCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("detect", "Find objects in an image, a folder of images or a data set");
  const auto arguments = std::make_shared<DetectArguments>();
  command->add_option("source", arguments->source, "image, folder, VOC data set or RGB-D sequence")
      ->required();
  arguments->detector.held = "any";
  arguments->detector.mirrored = true;
  arguments->detector.AddForPictures(*command);
  command->add_option("--list", arguments->list_file,
                      "file that names the wanted images by their stems, one per line");
  command->add_option("--confidence", arguments->detector.options.confidence, "least score")
      ->capture_default_str();
  command->add_option(
      "--json", arguments->json_file,
      "write {image stem: [[class, score, x0, y0, x1, y1], ...]}, pixels of the original image");
  command->add_option("--overlay", arguments->overlay_folder,
                      "folder for copies of the images with the boxes drawn in");
  command->callback([arguments] { Detect(*arguments); });
}

}  // namespace msf

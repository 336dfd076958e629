// msf-slam detector evaluate: how good a detector is on labelled images.
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/arguments.h"
#include "apps/detector_arguments.h"
#include "apps/detector_evaluation.h"
#include "apps/detector_plots.h"
#include "apps/overlay.h"
#include "evaluation/json_text.h"
#include "io/image_reader.h"
#include "io/png_encoder.h"
#include "util/atomic_file.h"
#include "util/progress.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

constexpr int kPerson = 14;  // in PascalVocClassNames()

struct EvaluateArguments {
  DetectorArguments detector;
  std::string data;
  int min_objects = 10;
  double false_per_image = 0.2;
  bool robustness = false;
  int limit = 0;
  fs::path json_file, plot_folder, overlay_folder;
};

// One row of the table about people.
struct PersonRow {
  std::string condition;
  RecallAtFalseRate result;
};

nlohmann::json ToJson(const DetectionMetrics& metrics, const std::vector<PersonRow>& person) {
  nlohmann::json json = {{"precision", metrics.precision},   {"recall", metrics.recall},
                         {"map50", metrics.map50},           {"map50_95", metrics.map50_95},
                         {"confidence", metrics.confidence}, {"num_classes", metrics.num_classes}};
  for (size_t i = 0; i < metrics.per_class.size(); ++i) {
    const ClassMetrics& c = metrics.per_class[i];
    json["per_class"][PascalVocClassNames()[i]] = {{"objects", c.num_objects},
                                                   {"precision", c.precision},
                                                   {"recall", c.recall},
                                                   {"ap50", c.ap50},
                                                   {"ap50_95", c.ap50_95}};
  }
  for (const PersonRow& row : person) {
    json["person_recall"][row.condition] = {{"recall", row.result.recall},
                                            {"score", row.result.score},
                                            {"objects", row.result.num_objects},
                                            {"false", row.result.num_false}};
  }
  return json;
}

// Copies of the images with what reaches `confidence`.
void WriteOverlays(const fs::path& folder, const std::vector<VocImage>& images,
                   const std::vector<ScoredImage>& scored, double confidence) {
  MakeFolder(folder);
  ImageReader reader;
  for (size_t i = 0; i < images.size(); ++i) {
    std::vector<Detection> shown;
    for (const Detection& d : scored[i].found) {
      if (d.score >= confidence) shown.push_back(d);
    }
    const cv::Mat drawn =
        DrawDetections(Require(reader.ReadColor(images[i].file)), shown, PascalVocClassNames());
    Require(WriteFileAtomically(folder / (images[i].id + ".png"), EncodePng(drawn)));
  }
}

std::vector<PersonRow> RunVariations(DetectorEvaluation& evaluation, double false_per_image) {
  std::vector<PersonRow> rows;
  const auto add = [&](const std::string& condition, StatusOr<std::vector<ScoredImage>> scored) {
    rows.push_back({condition, ComputeRecallAtFalseRate(Require(std::move(scored)), kPerson,
                                                        false_per_image)});
  };
  for (const int degrees : {0, 15, 30, 45, 90}) {
    add(fmt::format("rotated {} deg", degrees), evaluation.RunRotated(degrees, kTurnedCorners));
  }
  // The same pictures. After a quarter turn both boxes are the same.
  for (const int degrees : {15, 30, 45}) {
    add(fmt::format("outline {} deg", degrees), evaluation.RunRotated(degrees, kTurnedOutline));
  }
  for (const int percent : {0, 30, 50}) {
    add(fmt::format("cut {} %", percent), evaluation.RunCut(kPerson, percent / 100.0));
  }
  return rows;
}

void PrintPersonRows(const std::vector<PersonRow>& rows, double false_per_image) {
  std::cout << fmt::format(
      "\nperson recall at {} false boxes per image\n{:<16}{:>8}{:>9}{:>8}{:>8}\n", false_per_image,
      "condition", "recall", "objects", "false", "score");
  for (const PersonRow& row : rows) {
    std::cout << fmt::format("{:<16}{:>8.3f}{:>9}{:>8}{:>8.3f}\n", row.condition, row.result.recall,
                             row.result.num_objects, row.result.num_false, row.result.score);
  }
}

void Evaluate(EvaluateArguments& arguments) {
  RequireWritableFile(arguments.json_file);
  RequireWritableFolder(arguments.plot_folder);
  RequireWritableFolder(arguments.overlay_folder);
  const bool has_set = arguments.data.rfind(':') != std::string::npos;
  std::vector<VocImage> images = Require(
      LoadVocSet(has_set ? arguments.data : arguments.data + ":test", PascalVocClassNames()));
  if (arguments.limit > 0 && images.size() > static_cast<size_t>(arguments.limit)) {
    images.resize(static_cast<size_t>(arguments.limit));
  }
  DetectorOptions& options = arguments.detector.options;
  options.confidence = 0.001;
  options.every_class = true;
  const std::unique_ptr<Detector> detector = arguments.detector.Make();
  std::cerr << detector->description() << "\n";
  const int variations = arguments.robustness ? 12 : 1;
  Progress progress("evaluate", "images", static_cast<int>(images.size()) * variations);
  DetectorEvaluation evaluation = Require(DetectorEvaluation::Make(
      *detector, std::move(images), [&](int done) { progress.Update(done); }));
  const std::vector<ScoredImage> upright = Require(evaluation.RunUpright());
  const DetectionMetrics metrics = ComputeMetrics(
      upright, static_cast<int>(PascalVocClassNames().size()), arguments.min_objects);
  std::vector<PersonRow> person{
      {"upright", ComputeRecallAtFalseRate(upright, kPerson, arguments.false_per_image)}};
  if (arguments.robustness) {
    for (PersonRow& row : RunVariations(evaluation, arguments.false_per_image))
      person.push_back(std::move(row));
  }
  std::cout << FormatMetrics(metrics, PascalVocClassNames());
  std::cout << fmt::format(
      "P and R at confidence {:.3f}; means over classes with at least {} objects\n",
      metrics.confidence, arguments.min_objects);
  PrintPersonRows(person, arguments.false_per_image);
  if (!arguments.json_file.empty()) {
    Require(WriteFileAtomically(arguments.json_file, JsonText(ToJson(metrics, person))));
  }
  if (!arguments.plot_folder.empty()) {
    MakeFolder(arguments.plot_folder);
    Require(WriteFileAtomically(
        arguments.plot_folder / "precision_recall.svg",
        PlotPrecisionRecall(metrics, PascalVocClassNames(), arguments.min_objects)));
  }
  if (!arguments.overlay_folder.empty()) {
    WriteOverlays(arguments.overlay_folder, evaluation.images(), upright, metrics.confidence);
  }
}

}  // namespace

void AddDetectorEvaluateCommand(CLI::App& detector) {
  CLI::App* command =
      detector.add_subcommand("evaluate", "Score a detector on images in PASCAL VOC layout");
  const auto arguments = std::make_shared<EvaluateArguments>();
  command->add_option("--data", arguments->data, "VOC folder, ROOT (its test set) or ROOT:SET")
      ->required();
  arguments->detector.options.width = arguments->detector.options.height = 0;
  arguments->detector.size = "320x320";
  arguments->detector.AddForPictures(*command);
  command
      ->add_option("--min-objects", arguments->min_objects,
                   "classes with fewer objects do not enter the means")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  command
      ->add_option("--false-per-image", arguments->false_per_image,
                   "false person boxes per image for the person recall")
      ->check(NumberFrom(1e-6, 1000))
      ->capture_default_str();
  command->add_flag(
      "--robustness", arguments->robustness,
      "person recall also in turned images (rotated: objects labelled by the boxes around "
      "their turned corners; outline: by those around turned ellipses, which fit people "
      "far better) and with people cut off by the border");
  command->add_option("--limit", arguments->limit, "use the first images only; 0: all")
      ->check(CLI::Range(0, 1000000000));
  command->add_option("--json", arguments->json_file, "file for the figures");
  command->add_option("--plots", arguments->plot_folder,
                      "folder for the precision-recall curves (SVG)");
  command->add_option("--overlay", arguments->overlay_folder,
                      "folder for copies of the images with what was found");
  command->callback([arguments] { Evaluate(*arguments); });
}

}  // namespace msf

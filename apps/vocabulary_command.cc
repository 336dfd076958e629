// msf-slam train-vocabulary and vocabulary-info.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>

#include "apps/arguments.h"
#include "apps/command.h"
#include "apps/image_list.h"
#include "feature/orb_extractor.h"
#include "io/image_reader.h"
#include "place_recognition/vocabulary.h"
#include "place_recognition/vocabulary_training.h"
#include "util/progress.h"

namespace msf {
namespace {

struct TrainArguments {
  std::vector<std::string> sources;
  std::string file;
  int num_features = 500;
  VocabularyTrainingOptions training;
};

// All images of all sources.
std::vector<std::filesystem::path> ListImages(const std::vector<std::string>& sources) {
  std::vector<std::filesystem::path> images;
  for (const std::string& source : sources) {
    const std::vector<std::filesystem::path> more = Require(FindImages(source, {}));
    images.insert(images.end(), more.begin(), more.end());
  }
  return images;
}

std::vector<Descriptor> Describe(const cv::Mat& image, OrbExtractor& extractor) {
  RgbdFrame frame;
  frame.color = image;
  frame.depth = cv::Mat(image.size(), CV_16UC1, cv::Scalar(0));
  // Only descriptors are used, so any camera of the image's size will do.
  frame.camera = std::make_shared<const Camera>(
      Camera{.width = image.cols, .height = image.rows, .fx = 500, .fy = 500});
  return extractor.Extract(frame).descriptors;
}

// Descriptors per readable image; the others are named on stderr.
std::vector<std::vector<Descriptor>> DescribeAll(const std::vector<std::filesystem::path>& files,
                                                 int num_features) {
  OrbExtractor extractor({.num_features = num_features});
  ImageReader reader;
  Progress progress("train-vocabulary", "images", static_cast<int>(files.size()));
  std::vector<std::vector<Descriptor>> images;
  for (size_t i = 0; i < files.size(); ++i) {
    const StatusOr<cv::Mat> image = reader.ReadColor(files[i]);
    if (image.ok()) {
      images.push_back(Describe(*image, extractor));
    } else {
      std::cerr << "left out: " << image.message() << "\n";
    }
    progress.Update(static_cast<int>(i + 1));
  }
  return images;
}

void Print(const Vocabulary& vocabulary, const std::filesystem::path& file) {
  const VocabularyTree& tree = vocabulary.tree();
  float least = 0, most = 0;
  bool first = true;
  for (int node = 0; node < tree.num_nodes(); ++node) {
    if (!tree.IsWord(node)) continue;
    least = first ? tree.weights[node] : std::min(least, tree.weights[node]);
    most = first ? tree.weights[node] : std::max(most, tree.weights[node]);
    first = false;
  }
  std::cout << fmt::format(
      "{}\n  words      {}\n  nodes      {}\n  branching  {}\n  levels     {}\n  weights    {:.3f} "
      "to {:.3f} "
      "(ln of images / images with the word)\n  file size  {:.2f} MB\n",
      file.string(), vocabulary.num_words(), tree.num_nodes(), tree.branching, tree.levels, least,
      most, static_cast<double>(std::filesystem::file_size(file)) / 1e6);
}

void Train(const TrainArguments& arguments) {
  Require(arguments.training.Check());
  Require(OrbOptions{.num_features = arguments.num_features}.Check());
  RequireWritableFile(arguments.file);
  const std::vector<std::filesystem::path> files = ListImages(arguments.sources);
  const std::vector<std::vector<Descriptor>> images = DescribeAll(files, arguments.num_features);
  size_t num_descriptors = 0;
  for (const auto& image : images) num_descriptors += image.size();
  std::cerr << fmt::format("{} descriptors of {} images\n", num_descriptors, images.size());
  Progress progress("train-vocabulary", "steps", 1000);
  const Vocabulary vocabulary = Require(
      TrainVocabulary(images, arguments.training, [&](int done, int) { progress.Update(done); }));
  Require(vocabulary.Save(arguments.file));
  Print(vocabulary, arguments.file);
}

void ShowInfo(const std::string& file) {
  const auto start = std::chrono::steady_clock::now();
  const Vocabulary vocabulary = Require(Vocabulary::Load(file));
  const std::chrono::duration<double, std::milli> elapsed =
      std::chrono::steady_clock::now() - start;
  Print(vocabulary, file);
  std::cout << fmt::format("  load time  {:.1f} ms\n", elapsed.count());
}

}  // namespace

void AddVocabularyCommands(CLI::App& app) {
  CLI::App* train =
      app.add_subcommand("train-vocabulary", "Train a place recognition vocabulary on images");
  auto arguments = std::make_shared<TrainArguments>();
  train
      ->add_option("images", arguments->sources,
                   "images, folders of images, VOC data sets or RGB-D sequences")
      ->required();
  train->add_option("--out", arguments->file, "vocabulary file to write")->required();
  train->add_option("--branching", arguments->training.branching, "children of a node")
      ->capture_default_str();
  train->add_option("--levels", arguments->training.levels, "levels below the root")
      ->capture_default_str();
  train->add_option("--features", arguments->num_features, "points per image")
      ->capture_default_str();
  train->add_option("--seed", arguments->training.seed, "seed of the random choices")
      ->check(Seed())
      ->capture_default_str();
  train->callback([arguments] { Train(*arguments); });

  CLI::App* info = app.add_subcommand("vocabulary-info", "Show what a vocabulary file holds");
  auto file = std::make_shared<std::string>();
  info->add_option("file", *file, "vocabulary file")->required();
  info->callback([file] { ShowInfo(*file); });
}

}  // namespace msf

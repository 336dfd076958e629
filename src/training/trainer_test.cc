#include "training/trainer.h"

#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace msf {
namespace {

struct Interruption : std::runtime_error {
  Interruption() : std::runtime_error("interrupted") {}
};

ModelConfig TinyModel() {
  ModelConfig config;
  config.classes = {"square", "disc"};
  return config;
}

TrainOptions TinyTraining() {
  TrainOptions options;
  options.epochs = 2;
  options.batch = 2;
  options.side = 64;
  options.validation_images = 2;
  options.freeze_layers = 0;
  options.freeze_norms = false;
  options.optimizer.learning_rate = 1e-3;
  return options;
}

std::vector<LabeledImage> TinyImages() {
  std::vector<LabeledImage> images;
  for (int i = 0; i < 6; ++i) {
    LabeledImage image{cv::Mat(64, 64, CV_8UC3, cv::Scalar(40 * i, 90, 60)), {}};
    const cv::Rect box(8 + 2 * i, 10, 24, 24);
    if (i % 2 == 0) {
      cv::rectangle(image.pixels, box, cv::Scalar(255, 255, 255), cv::FILLED);
    } else {
      cv::circle(image.pixels, {box.x + 12, box.y + 12}, 12, cv::Scalar(20, 20, 250), cv::FILLED);
    }
    image.objects.push_back(
        {i % 2, static_cast<float>(box.x), 10, static_cast<float>(box.x + 24), 34, false});
    images.push_back(std::move(image));
  }
  return images;
}

Trainer MakeTrainer(const TrainOptions& options, int interrupt_in_epoch) {
  return Trainer(TinyModel(), options, TinyImages(),
                 [interrupt_in_epoch](const TrainProgress& progress) {
                   if (progress.epoch == interrupt_in_epoch) throw Interruption();
                 });
}

std::filesystem::path FreshFolder(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / name;
  std::filesystem::remove_all(folder);
  return folder;
}

TEST(TrainerTest, ResumedTrainingGivesTheSameWeights) {
  const std::filesystem::path whole = FreshFolder("whole"), broken = FreshFolder("broken");
  Trainer uninterrupted = MakeTrainer(TinyTraining(), -1);
  ASSERT_TRUE(uninterrupted.Run(whole).ok());

  Trainer interrupted = MakeTrainer(TinyTraining(), 1);
  EXPECT_THROW((void)interrupted.Run(broken), Interruption);
  Trainer resumed = MakeTrainer(TinyTraining(), -1);
  const Status status = resumed.Run(broken);
  ASSERT_TRUE(status.ok()) << status.message();

  ASSERT_EQ(resumed.records().size(), 2U);
  for (const auto& [name, tensor] : uninterrupted.weights()) {
    ASSERT_TRUE(tensor.equal(resumed.weights().at(name))) << name;
  }
  EXPECT_TRUE(std::filesystem::exists(broken / "curves.svg"));
  std::ifstream csv(broken / "curves.csv");
  int lines = 0;
  for (std::string line; std::getline(csv, line);) ++lines;
  EXPECT_EQ(lines, 3);
}

TEST(TrainerTest, CheckpointOfAnotherTrainingIsRefused) {
  const std::filesystem::path folder = FreshFolder("other");
  TrainOptions options = TinyTraining();
  options.epochs = 1;
  ASSERT_TRUE(MakeTrainer(options, -1).Run(folder).ok());
  options.seed = 9;
  const Status status = MakeTrainer(options, -1).Run(folder);
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.message().find("other options"), std::string::npos) << status.message();
}

TEST(TrainerTest, FrozenLayersKeepTheirWeights) {
  TrainOptions options = TinyTraining();
  options.epochs = 1;
  options.validation_images = 0;
  options.freeze_layers = 3;
  options.average_decay = 0.5;
  const Network start(BuildModelGraph(TinyModel()), static_cast<uint64_t>(options.seed));
  Trainer trainer = MakeTrainer(options, -1);
  ASSERT_TRUE(trainer.Run(FreshFolder("frozen")).ok());
  for (const char* name :
       {"model.0.conv.weight", "model.2.cv2.bn.weight", "model.1.bn.running_mean"}) {
    const auto& tensors = start.parameters().contains(name) ? start.parameters() : start.buffers();
    EXPECT_TRUE(trainer.weights().at(name).allclose(tensors.at(name), 1e-6, 1e-7)) << name;
  }
  EXPECT_FALSE(trainer.weights()
                   .at("model.3.conv.weight")
                   .allclose(start.parameters().at("model.3.conv.weight"), 1e-6, 1e-7));
}

// All pictures are turned by a quarter: whether they are held to the teacher is the option's
// matter.
TEST(TrainerTest, TurnedPicturesImitateTheTeacherWhereWanted) {
  TrainOptions options = TinyTraining();
  options.epochs = 1;
  options.validation_images = 0;
  Trainer first = MakeTrainer(options, -1);
  ASSERT_TRUE(first.Run(FreshFolder("teacher")).ok());
  options.augmentation.rotate_upright = 0.0;
  options.augmentation.rotate_quarter = 1.0;
  for (const bool wanted : {false, true}) {
    options.imitate_turned = wanted;
    Trainer second = MakeTrainer(options, -1);
    Status status = second.Initialize(first.weights());
    ASSERT_TRUE(status.ok()) << status.message();
    status = second.StartFrom(first.weights());
    ASSERT_TRUE(status.ok()) << status.message();
    ASSERT_TRUE(second.Run(FreshFolder("student")).ok());
    EXPECT_EQ(second.records()[0].imitation_loss > 0.0, wanted);
  }
}

TEST(TrainerTest, LayersAreHeldToTheTeachersWhereWanted) {
  TrainOptions options = TinyTraining();
  options.epochs = 1;
  options.validation_images = 0;
  options.imitation = 0;
  options.augmentation.rotate_upright = 1.0;
  options.augmentation.rotate_quarter = 0.0;
  const Network teacher(BuildModelGraph(TinyModel()), 1), start(BuildModelGraph(TinyModel()), 2);
  for (const double weight : {0.0, 1.0}) {
    options.feature_imitation = weight;
    Trainer trainer = MakeTrainer(options, -1);
    ASSERT_TRUE(trainer.Initialize(teacher.State()).ok());
    ASSERT_TRUE(trainer.StartFrom(start.State()).ok());
    ASSERT_TRUE(trainer.Run(FreshFolder("student_of_layers")).ok());
    EXPECT_EQ(trainer.records()[0].feature_loss > 0, weight > 0);
  }
}

TEST(TrainOptionsTest, NonsenseIsRefused) {
  TrainOptions options;
  EXPECT_TRUE(options.Check().ok());
  options.side = 100;
  EXPECT_FALSE(options.Check().ok());
}

TEST(BatchTest, RareClassesAreShownMoreOften) {
  std::vector<LabeledImage> images(20);
  for (int i = 0; i < 20; ++i) images[i].objects.push_back({i == 0 ? 1 : 0, 0, 0, 1, 1, false});
  const std::vector<double> weights = BalancingWeights(images, 0.5);
  EXPECT_NEAR(weights[0], std::sqrt(0.15 / 0.05), 1e-9);
  EXPECT_EQ(weights[1], 1.0);
  EXPECT_EQ(BalancingWeights(images, 0.0)[0], 1.0);
}

TEST(BatchTest, ChannelsBecomeRgb) {
  const torch::Tensor tensor =
      ImagesToTensor({{cv::Mat(2, 2, CV_8UC3, cv::Scalar(255, 0, 51)), {}}});  // blue, green, red
  EXPECT_NEAR(tensor[0][0][0][0].item<float>(), 0.2F, 1e-6);
  EXPECT_NEAR(tensor[0][2][1][1].item<float>(), 1.0F, 1e-6);
}

}  // namespace
}  // namespace msf

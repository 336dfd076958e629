#include "training/network.h"

#include <gtest/gtest.h>
#include <torch/types.h>
#include <torch/utils.h>

#include "training/distillation.h"
#include "training/fast_silu.h"
#include "training/least_squares.h"
#include "training/model_config.h"
#include "training/msf_initialization.h"
#include "training/weight_adaptation.h"

namespace msf {
namespace {

ModelConfig SmallConfig(const std::string& placement) {
  ModelConfig config;
  config.classes = {"person", "cat"};
  config.msf_placement = placement;
  return config;
}

// Random networks have dull features; some spread in the norms makes them livelier.
void Enliven(Network& network) {
  const torch::NoGradGuard no_grad;
  torch::manual_seed(3);
  for (const auto& [name, tensor] : network.parameters()) {
    torch::Tensor target = tensor;
    if (name.ends_with(".bn.weight")) target.uniform_(1.5, 2.5);
    if (name.ends_with(".bn.bias")) target.uniform_(-0.5, 0.5);
  }
}

TEST(FastSiluTest, AgreesWithLibtorch) {
  torch::manual_seed(1);
  for (const auto type : {torch::kFloat, torch::kBFloat16}) {
    for (const auto format : {torch::MemoryFormat::Contiguous, torch::MemoryFormat::ChannelsLast}) {
      const torch::Tensor x = (torch::randn({2, 5, 3, 7}) * 6.0).to(type).contiguous(format);
      const torch::Tensor weight =
          torch::randn({2, 5, 3, 7}).to(type);  // its gradient arrives in another memory order
      torch::Tensor a = x.clone().requires_grad_(true), b = x.clone().requires_grad_(true);
      const torch::Tensor ours = FastSilu(a), theirs = at::silu(b);
      (ours * weight).sum().backward();
      (theirs * weight).sum().backward();
      const double tolerance = type == torch::kFloat ? 1e-5 : 0.02;
      EXPECT_TRUE(torch::allclose(ours, theirs, tolerance, tolerance)) << type;
      EXPECT_TRUE(torch::allclose(a.grad(), b.grad(), tolerance, tolerance)) << type;
    }
  }
  const torch::Tensor extremes = FastSilu(torch::tensor({-1e4F, -200.0F, 0.0F, 200.0F, 1e4F}));
  EXPECT_TRUE(torch::allclose(extremes, torch::tensor({0.0F, 0.0F, 0.0F, 200.0F, 1e4F})));
}

TEST(FastSiluTest, SlicesWithGapsWork) {
  torch::Tensor x =
      torch::randn({2, 6, 4, 4}).contiguous(torch::MemoryFormat::ChannelsLast).requires_grad_(true);
  FastSilu(x.narrow(1, 2, 3)).sum().backward();
  EXPECT_EQ(x.grad().narrow(1, 0, 2).abs().sum().item<float>(), 0.0F);
  EXPECT_GT(x.grad().narrow(1, 2, 3).abs().sum().item<float>(), 0.0F);
}

TEST(NetworkTest, HeadsHaveTheirShapes) {
  for (const char* name : {"yolov8n", "yolov8n_msf", "yolov8n_msf_wide", "yolov8n_msf_full",
                           "yolov8n_fpn", "yolov8n_hrnet"}) {
    const Network network(BuildModelGraph(*LoadModelConfig(name)), 0);
    const torch::NoGradGuard no_grad;
    const HeadOutputs heads = network.Forward(torch::rand({1, 3, 64, 96}));
    for (int i = 0; i < 3; ++i) {
      const int64_t stride = 8LL << i;
      EXPECT_EQ(heads.boxes[i].sizes(), (std::vector<int64_t>{1, 64, 64 / stride, 96 / stride}))
          << name;
      EXPECT_EQ(heads.classes[i].sizes(), (std::vector<int64_t>{1, 20, 64 / stride, 96 / stride}))
          << name;
    }
  }
}

TEST(NetworkTest, SeedDecidesTheWeights) {
  const ModelGraph graph = BuildModelGraph(SmallConfig("none"));
  const Network a(graph, 5), b(graph, 5), c(graph, 6);
  const std::string name = "model.3.conv.weight";
  EXPECT_TRUE(a.parameters().at(name).equal(b.parameters().at(name)));
  EXPECT_FALSE(a.parameters().at(name).equal(c.parameters().at(name)));
}

TEST(NetworkTest, FoldedNormsGiveWhatSeparateOnesGive) {
  Network network(BuildModelGraph(SmallConfig("none")), 1);
  Enliven(network);
  const torch::NoGradGuard no_grad;
  const torch::Tensor x = torch::rand({2, 3, 64, 64});
  network.set_training(true);
  for (int i = 0; i < 300; ++i) {  // until the running statistics are the batch's
    std::vector<torch::Tensor> values(network.graph().nodes.size());
    values[0] = x;
    network.RunNodes(1, 2, values);
  }
  std::vector<torch::Tensor> batch(network.graph().nodes.size()),
      running(network.graph().nodes.size());
  batch[0] = running[0] = x;
  network.RunNodes(1, 2, batch);
  network.set_training(false);
  network.RunNodes(1, 2, running);
  EXPECT_TRUE(torch::allclose(batch[1], running[1], 1e-2, 1e-2));
}

TEST(NetworkTest, WeightsThatDoNotFitAreNamed) {
  Network network(BuildModelGraph(SmallConfig("none")), 0);
  NamedTensors state = network.State();
  state.erase("model.4.cv1.conv.weight");
  const Status status = network.Load(state);
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.message().find("model.4.cv1.conv.weight"), std::string::npos);
}

TEST(TensorFileTest, RoundTripAndErrors) {
  const std::filesystem::path folder = testing::TempDir();
  const NamedTensors tensors = {{"a", torch::rand({2, 3})}, {"b", torch::tensor(4.0F)}};
  ASSERT_TRUE(SaveTensors(folder / "tensors.pt", tensors).ok());
  const StatusOr<NamedTensors> loaded = LoadTensors(folder / "tensors.pt");
  ASSERT_TRUE(loaded.ok()) << loaded.message();
  EXPECT_TRUE(loaded->at("a").equal(tensors.at("a")));
  EXPECT_FALSE(LoadTensors(folder / "absent.pt").ok());
}

TEST(WeightAdaptationTest, RowsFollowClassNames) {
  const Network coco(BuildModelGraph(*LoadModelConfig("yolov8n_coco")), 0);
  const ModelGraph target = BuildModelGraph(*LoadModelConfig("yolov8n"));
  const StatusOr<NamedTensors> adapted = AdaptWeights(coco.State(), target);
  ASSERT_TRUE(adapted.ok()) << adapted.message();
  const std::string name = "model.22.cv3.0.2.";
  // person is row 14 of VOC and 0 of COCO, sofa 17 and 57 (couch).
  const torch::Tensor voc = adapted->at(name + "bias"),
                      source = coco.parameters().at(name + "bias");
  EXPECT_EQ(voc.size(0), 20);
  EXPECT_EQ(voc[14].item<float>(), source[0].item<float>());
  EXPECT_EQ(voc[17].item<float>(), source[57].item<float>());
  EXPECT_EQ(adapted->at(name + "weight").size(1), 64);
  Network network(target, 1);
  EXPECT_TRUE(network.Load(*adapted).ok());
}

TEST(WeightAdaptationTest, WrongClassCountIsAnError) {
  const Network two(BuildModelGraph(SmallConfig("none")), 0);
  const StatusOr<NamedTensors> adapted =
      AdaptWeights(two.State(), BuildModelGraph(*LoadModelConfig("yolov8n")));
  ASSERT_FALSE(adapted.ok());
  EXPECT_NE(adapted.message().find("2 classes"), std::string::npos) << adapted.message();
}

TEST(LeastSquaresTest, FindsTheMapThatMadeTheData) {
  torch::manual_seed(2);
  const torch::Tensor features = torch::randn({200, 6}), map = torch::randn({6, 3});
  EXPECT_TRUE(torch::allclose(SolveLeastSquares(features, features.mm(map)), map, 1e-2, 1e-2));
  const torch::Tensor vectors =
      LeadingEigenvectors(torch::diag(torch::tensor({1.0F, 5.0F, 3.0F})), 2);
  EXPECT_NEAR(vectors[1].abs().max().item<float>(), 1.0F, 1e-5);
  EXPECT_NEAR(vectors[0].abs().max().item<float>(), 0.0F, 1e-5);
}

// The closed form and the layer-wise distillation must speak of the same blocks in the same order:
// the error that the one computes is the error that the other measures.
TEST(MsfInitializationTest, BlocksReproduceTheTeacher) {
  Network teacher(BuildModelGraph(SmallConfig("none")), 0),
      student(BuildModelGraph(SmallConfig("all")), 1);
  Enliven(teacher);
  const std::vector<std::string> missing = student.LoadMatching(teacher.State());
  torch::manual_seed(4);
  const torch::Tensor images =
      at::upsample_bilinear2d(torch::rand({6, 3, 16, 16}), {128, 128}, false);
  const LayerDistillation distillation(student, teacher, missing);
  ASSERT_EQ(distillation.layers(), (std::vector<int>{0, 1, 3, 5, 7, 16, 19}));
  const double before = distillation.Errors(images, false)[0];
  const std::map<int, double> errors = InitializeMsfLayers(student, teacher, images);
  ASSERT_EQ(errors.size(), 7U);
  const double after = distillation.Errors(images, false)[0];
  EXPECT_LT(after, 0.2);
  EXPECT_LT(after, 0.2 * before);
  EXPECT_NEAR(after, errors.at(0), 0.1);
}

std::vector<torch::Tensor> ValuesOf(const Network& network, const torch::Tensor& images) {
  std::vector<torch::Tensor> values(network.graph().nodes.size());
  values[0] = images;
  network.RunNodes(1, static_cast<int>(values.size()), values);
  return values;
}

// A block as wide as its output begins as the teacher's convolution itself.
TEST(MsfInitializationTest, FullWidthBlocksTakeTheTeacherOver) {
  ModelConfig config = SmallConfig("3:1,5:1");
  Network teacher(BuildModelGraph(SmallConfig("none")), 0), student(BuildModelGraph(config), 1);
  Enliven(teacher);
  student.LoadMatching(teacher.State());
  torch::manual_seed(4);
  const torch::Tensor images = torch::rand({2, 3, 64, 64});
  for (const auto& [layer, error] : InitializeMsfLayers(student, teacher, images))
    EXPECT_LT(error, 1e-8) << layer;
  const torch::NoGradGuard no_grad;
  teacher.set_training(false);
  const torch::Tensor others = torch::rand({1, 3, 96, 64});
  const auto last = [&](const Network& network) {
    return ValuesOf(network, others)[network.graph().class_heads[2]];
  };
  EXPECT_TRUE(torch::allclose(last(student), last(teacher), 1e-3, 1e-4));
}

TEST(FeatureDistanceTest, CountsHowFarTheLayersOfTheChosenPicturesAre) {
  Network teacher(BuildModelGraph(SmallConfig("none")), 1);
  Enliven(teacher);
  Network student(BuildModelGraph(SmallConfig("none")), 1);
  ASSERT_TRUE(student.Load(teacher.State()).ok());
  torch::manual_seed(5);
  const torch::Tensor images = torch::rand({2, 3, 64, 64});
  const std::vector<torch::Tensor> wanted = ValuesOf(teacher, images);
  // The second picture is another one for the student.
  torch::Tensor changed = images.clone();
  changed[1] = torch::rand({3, 64, 64});
  const std::vector<torch::Tensor> given = ValuesOf(student, changed);
  const auto distance = [&](const torch::Tensor& pictures) {
    return FeatureDistance(student.graph(), given, teacher.graph(), wanted, pictures)
        .item<double>();
  };
  EXPECT_NEAR(distance(torch::tensor({0})), 0, 1e-6);
  EXPECT_GT(distance(torch::tensor({1})), 0.01);
  EXPECT_EQ(distance(torch::empty({0}, torch::kLong)), 0);
}

// Averaged logits are those of the mirror image, mirrored; nothing else changes.
TEST(AverageClassesWithMirrorTest, MirrorImagesGetMirroredLogits) {
  Network network(BuildModelGraph(SmallConfig("none")), 1);
  Enliven(network);
  const torch::NoGradGuard no_grad;
  torch::manual_seed(6);
  const torch::Tensor images = torch::rand({2, 3, 64, 64});
  const std::vector<torch::Tensor> once = ValuesOf(network, images);
  std::vector<torch::Tensor> values = once, mirrored = ValuesOf(network, images.flip(3));
  AverageClassesWithMirror(network, values);
  AverageClassesWithMirror(network, mirrored);
  for (size_t i = 0; i < network.graph().class_heads.size(); ++i) {
    const int head = network.graph().class_heads[i], box = network.graph().box_heads[i];
    EXPECT_TRUE(values[head].allclose(mirrored[head].flip(3), 1e-4, 1e-4));
    EXPECT_FALSE(values[head].allclose(once[head], 1e-4, 1e-4));
    EXPECT_TRUE(values[box].equal(once[box]));
  }
}

}  // namespace
}  // namespace msf

#include "training/model_blocks.h"

#include <algorithm>

namespace msf {

namespace {

int DepthwiseBranch(GraphBuilder& build, const std::string& name, int input, int kernel) {
  const int width = build.node(input).channels;
  const int depthwise = build.RawConv(
      {.name = name + ".dw", .channels = width, .kernel = kernel, .groups = width}, input);
  return build.RawConv({.name = name + ".pw", .channels = width, .normalized = true}, depthwise);
}

}  // namespace

int ConvLayer(GraphBuilder& build, int input, int channels, int kernel, int stride) {
  build.BeginLayer("Conv");
  return build.Conv(build.LayerName(), input, channels, kernel, stride);
}

int MsfConvLayer(GraphBuilder& build, int input, int channels, const MsfConvShape& shape) {
  build.BeginLayer("MSFConv");
  const std::string name = build.LayerName();
  const int width = std::max(1, static_cast<int>(channels * shape.width));
  const int conv = build.Conv(name + ".cv1", input, width, 3, 2);
  std::vector<int> branches;
  for (size_t i = 0; i < shape.kernels.size(); ++i) {
    branches.push_back(
        DepthwiseBranch(build, name + ".dw" + std::to_string(i), conv, shape.kernels[i]));
  }
  const int standard = build.RawConv({.name = name + ".std",
                                      .channels = width,
                                      .kernel = shape.standard_kernel,
                                      .normalized = true},
                                     conv);
  branches.insert(branches.begin() + std::min<long>(1, static_cast<long>(branches.size())),
                  standard);
  if (build.node(input).channels == width) {
    const int residual = build.AveragePool(input, 2);
    for (int& branch : branches) branch = build.Add(branch, residual);
  }
  const int activated = build.Norm(name + ".norm", build.Concat(branches));
  return build.RawConv({.name = name + ".cv2", .channels = channels}, activated);
}

int C2fLayer(GraphBuilder& build, int input, int channels, int repeats, bool shortcut) {
  build.BeginLayer("C2f");
  const std::string name = build.LayerName();
  const int half = channels / 2;
  const int both = build.Conv(name + ".cv1", input, 2 * half);
  std::vector<int> pieces = {build.Slice(both, 0, half), build.Slice(both, half, half)};
  for (int i = 0; i < repeats; ++i) {
    const std::string inner = name + ".m." + std::to_string(i);
    const int first = build.Conv(inner + ".cv1", pieces.back(), half, 3);
    const int second = build.Conv(inner + ".cv2", first, half, 3);
    pieces.push_back(shortcut ? build.Add(pieces.back(), second) : second);
  }
  return build.Conv(name + ".cv2", build.Concat(pieces), channels);
}

int SppfLayer(GraphBuilder& build, int input, int channels) {
  build.BeginLayer("SPPF");
  const std::string name = build.LayerName();
  std::vector<int> pieces = {build.Conv(name + ".cv1", input, channels / 2)};
  for (int i = 0; i < 3; ++i) pieces.push_back(build.MaxPool(pieces.back(), 5, 1));
  return build.Conv(name + ".cv2", build.Concat(pieces), channels);
}

int UpsampleLayer(GraphBuilder& build, int input) {
  build.BeginLayer("Upsample");
  return build.Upsample(input);
}

int ConcatLayer(GraphBuilder& build, const std::vector<int>& inputs) {
  build.BeginLayer("Concat");
  return build.Concat(inputs);
}

Pyramid FpnNeck(GraphBuilder& build, const Pyramid& stages) {
  Pyramid merged = stages;
  for (int i = 1; i >= 0; --i) {
    build.BeginLayer("Lateral");
    const int brought =
        build.Conv(build.LayerName(), merged[i + 1], build.node(stages[i]).channels);
    merged[i] = build.Add(stages[i], build.Upsample(brought));
  }
  for (int& map : merged) map = ConvLayer(build, map, build.node(map).channels, 3, 1);
  return merged;
}

namespace {

// `input` brought to `scale` and `channels`: 1x1 and upsampling, or a chain of stride-2
// convolutions.
int Bring(GraphBuilder& build, const std::string& name, int input, int scale, int channels) {
  int x = input;
  for (int step = 0; build.node(x).scale < scale; ++step) {
    const bool last = build.node(x).scale * 2 == scale;
    x = build.Conv(name + ".down" + std::to_string(step), x,
                   last ? channels : build.node(x).channels, 3, 2);
  }
  if (build.node(x).scale > scale) x = build.Conv(name + ".up", x, channels);
  while (build.node(x).scale > scale) x = build.Upsample(x);
  return x;
}

int ResidualLayer(GraphBuilder& build, int input) {
  build.BeginLayer("Residual");
  const int channels = build.node(input).channels;
  const bool coarse = build.node(input).scale == 32;
  int x = input;
  for (int i = 0; i < (coarse ? 2 : 1); ++i) {
    const std::string name = build.LayerName() + "." + std::to_string(i);
    const int first = build.Conv(name + ".cv1", x, coarse ? channels * 5 / 4 : channels / 2, 3);
    x = build.Add(x, build.Conv(name + ".cv2", first, channels, 3));
  }
  return x;
}

}  // namespace

Pyramid ExchangeNeck(GraphBuilder& build, const Pyramid& stages, int units) {
  Pyramid maps = stages;
  for (int unit = 0; unit < units; ++unit) {
    for (int& map : maps) map = ResidualLayer(build, map);
    Pyramid fused = maps;
    for (int to = 0; to < 3; ++to) {
      build.BeginLayer("Exchange");
      const GraphNode target = build.node(maps[to]);
      for (int from = 0; from < 3; ++from) {
        if (from == to) continue;
        const std::string name = build.LayerName() + "." + std::to_string(from);
        fused[to] =
            build.Add(fused[to], Bring(build, name, maps[from], target.scale, target.channels));
      }
    }
    maps = fused;
  }
  return maps;
}

}  // namespace msf

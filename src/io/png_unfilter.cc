#include "io/png_unfilter.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

namespace msf {
namespace {

enum Filter : uint8_t { kNone = 0, kSub = 1, kUp = 2, kAverage = 3, kPaeth = 4 };

// Undoes one row; `predict(left, up, up_left)` gives what the encoder subtracted.
template <int N, typename Predict>
void UnfilterRowWith(const uint8_t* row, const uint8_t* up, int width, uint8_t* out,
                     Predict predict) {
  for (int c = 0; c < N; ++c) {
    out[c] = static_cast<uint8_t>(row[N - 1 - c] + predict(0, up[c], 0));
  }
  for (int x = N; x < width * N; x += N) {
    for (int c = 0; c < N; ++c) {
      const int i = x + c;
      out[i] = static_cast<uint8_t>(row[x + N - 1 - c] + predict(out[i - N], up[i], up[i - N]));
    }
  }
}

// Undoes one row of any filter but Paeth's.
template <int N>
bool UnfilterRow(uint8_t filter, const uint8_t* row, const uint8_t* up, int width, uint8_t* out) {
  switch (filter) {
    case kNone:
      UnfilterRowWith<N>(row, up, width, out, [](int, int, int) { return 0; });
      return true;
    case kSub:
      UnfilterRowWith<N>(row, up, width, out, [](int left, int, int) { return left; });
      return true;
    case kUp:
      UnfilterRowWith<N>(row, up, width, out, [](int, int above, int) { return above; });
      return true;
    case kAverage:
      UnfilterRowWith<N>(row, up, width, out,
                         [](int left, int above, int) { return (left + above) / 2; });
      return true;
    default:
      return false;
  }
}

// Undoes up to kWave successive Paeth rows at once. A pixel needs its left and upper neighbours, so
// row r runs r pixels behind row 0 and all rows advance together: each row is one group of four
// lanes. Encoders choose this filter for nearly every row of a photograph, and one row alone is a
// chain of dependent operations that leaves the processor idle.
constexpr int kWave = 4;
using Bytes = uint8_t __attribute__((vector_size(4 * kWave)));
using Lanes = int16_t __attribute__((vector_size(8 * kWave)));

inline Lanes Abs(Lanes v) { return v < 0 ? -v : v; }

template <int N>
class PaethWave {
 public:
  // `rows`: the filtered rows without their filter bytes; `outs`: where they go.
  PaethWave(const std::array<const uint8_t*, kWave>& rows, const uint8_t* up, int width,
            const std::array<uint8_t*, kWave>& outs)
      : rows_(rows), up_(up), width_(width), outs_(outs) {}

  void Run() {
    int step = 0;
    for (; step < std::min(kWave - 1, width_ + kWave - 1); ++step) Step<false>(step);
    for (; step < width_ - 1; ++step) Step<true>(step);
    for (; step < width_ + kWave - 1; ++step) Step<false>(step);
  }

 private:
  // kInside: all rows are at a pixel that is neither outside of the image nor the last of its row,
  // so that two pixels may be read and written; the superfluous bytes belong to the next pixel,
  // which is written later.
  template <bool kInside>
  void Step(int step) {
    constexpr int kCopied = kInside && N >= 2 ? 4 : N;
    std::array<uint32_t, kWave> words{};
    uint32_t above = 0;
    for (int r = 0; r < kWave; ++r) {
      const int x = step - r;
      if (kInside || (x >= 0 && x < width_)) std::memcpy(&words[r], rows_[r] + x * N, 4);
    }
    if (kInside || step < width_) std::memcpy(&above, up_ + step * N, kCopied);
    const Bytes result = Advance(words, above);
    std::memcpy(words.data(), &result, sizeof(result));
    for (int r = 0; r < kWave; ++r) {
      const int x = step - r;
      if (kInside || (x >= 0 && x < width_)) {
        std::memcpy(outs_[r] + x * N, &words[r], kCopied);
      }
    }
  }

  // One pixel of each row: `words` holds the filtered pixels, `above` the pixel over row 0's.
  Bytes Advance(const std::array<uint32_t, kWave>& words, uint32_t above) {
    Bytes bytes;
    std::memcpy(&bytes, words.data(), sizeof(bytes));
    const Lanes raw = __builtin_convertvector(ReversePixels(bytes), Lanes);
    Bytes above_bytes{};
    std::memcpy(&above_bytes, &above, sizeof(above));
    // Above row r's pixel is what row r - 1 gave one step ago.
    const Lanes up =
        __builtin_shufflevector(__builtin_convertvector(above_bytes, Lanes), left_, 0, 1, 2, 3, 16,
                                17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27);
    const Lanes to_left = Abs(up - up_left_);
    const Lanes to_up = Abs(left_ - up_left_);
    const Lanes to_up_left = Abs((left_ - up_left_) + (up - up_left_));
    const Lanes of_uppers = to_up <= to_up_left ? up : up_left_;
    const Lanes nearest_upper = to_up < to_up_left ? to_up : to_up_left;
    const Lanes prediction = to_left <= nearest_upper ? left_ : of_uppers;
    left_ = (raw + prediction) & 0xff;
    up_left_ = up;
    return __builtin_convertvector(left_, Bytes);
  }

  static Bytes ReversePixels(Bytes b) {
    if constexpr (N == 3) {
      return __builtin_shufflevector(b, b, 2, 1, 0, 3, 6, 5, 4, 7, 10, 9, 8, 11, 14, 13, 12, 15);
    } else if constexpr (N == 2) {
      return __builtin_shufflevector(b, b, 1, 0, 2, 3, 5, 4, 6, 7, 9, 8, 10, 11, 13, 12, 14, 15);
    } else {
      return b;
    }
  }

  const std::array<const uint8_t*, kWave> rows_;
  const uint8_t* const up_;
  const int width_;
  const std::array<uint8_t*, kWave> outs_;
  Lanes left_{};
  Lanes up_left_{};
};

}  // namespace

template <int kPixelBytes>
bool UnfilterPng(const uint8_t* filtered, int width, int height, uint8_t* out, size_t out_stride) {
  const size_t stride = 1 + static_cast<size_t>(width) * kPixelBytes;
  const std::vector<uint8_t> zeros(stride, 0);
  std::vector<uint8_t> unused(stride);  // a wave of fewer rows lets the others write here
  const uint8_t* up = zeros.data();
  for (int y = 0; y < height;) {
    const uint8_t* row = filtered + y * stride;
    std::array<const uint8_t*, kWave> rows{};
    std::array<uint8_t*, kWave> outs{};
    rows.fill(row + 1);
    outs.fill(unused.data());
    int num_paeth = 0;
    for (; num_paeth < kWave && y + num_paeth < height && row[num_paeth * stride] == kPaeth;
         ++num_paeth) {
      rows[num_paeth] = row + num_paeth * stride + 1;
      outs[num_paeth] = out + (y + num_paeth) * out_stride;
    }
    if (num_paeth > 0) {
      PaethWave<kPixelBytes>(rows, up, width, outs).Run();
      y += num_paeth;
    } else {
      if (!UnfilterRow<kPixelBytes>(row[0], row + 1, up, width, out + y * out_stride)) return false;
      ++y;
    }
    up = out + (y - 1) * out_stride;
  }
  return true;
}

template bool UnfilterPng<1>(const uint8_t*, int, int, uint8_t*, size_t);
template bool UnfilterPng<2>(const uint8_t*, int, int, uint8_t*, size_t);
template bool UnfilterPng<3>(const uint8_t*, int, int, uint8_t*, size_t);

}  // namespace msf

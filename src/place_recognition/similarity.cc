#include "place_recognition/similarity.h"

#include <algorithm>

namespace msf {

double SimilarityScore(const BagOfWords& a, const BagOfWords& b) {
  // With both sums 1 the distance is 2 - 2 * (sum of the lesser weights), which only common words
  // have.
  double score = 0;
  auto in_a = a.words.begin();
  auto in_b = b.words.begin();
  while (in_a != a.words.end() && in_b != b.words.end()) {
    if (in_a->first < in_b->first) {
      ++in_a;
    } else if (in_b->first < in_a->first) {
      ++in_b;
    } else {
      score += std::min((in_a++)->second, (in_b++)->second);
    }
  }
  return score;
}

}  // namespace msf

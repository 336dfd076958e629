// How alike two images are.
#pragma once

#include "feature/bag_of_words.h"

namespace msf {

// L1 score of two bags whose weights sum to 1: 1 - |a - b|_1 / 2, from 0 (no common word) to 1 (the
// same) (Nister and Stewenius, CVPR 2006).
double SimilarityScore(const BagOfWords& a, const BagOfWords& b);

}  // namespace msf

// Teaching parts of a network to reproduce what a trained one (the teacher) computes, so that new
// blocks need little data.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "training/network.h"

namespace msf {

// Layer-wise feature distillation: every layer of the student that the teacher's weights do not
// fill gets the *teacher's* inputs and learns to give the teacher's output; all such layers learn
// at once from one pass of the teacher.
class LayerDistillation {
 public:
  // `new_tensors`: the student's tensors that have no counterpart in the teacher. The student's
  // layers must correspond one to one to the teacher's from the first on; comparing stops at the
  // first that does not (a different neck). The teacher's class heads must give the student's
  // classes.
  LayerDistillation(const Network& student, const Network& teacher,
                    const std::vector<std::string>& new_tensors);

  // Layers that learn.
  const std::vector<int>& layers() const { return layers_; }
  // Mean over the learning layers of the squared error over the teacher's variance, for the images;
  // to be minimised.
  torch::Tensor Loss(const torch::Tensor& images, bool bfloat16) const;
  // The same, per learning layer, as numbers.
  std::vector<double> Errors(const torch::Tensor& images, bool bfloat16) const;

 private:
  std::vector<torch::Tensor> LayerErrors(const torch::Tensor& images, bool bfloat16) const;
  torch::Tensor LayerError(int layer, std::vector<torch::Tensor>& values,
                           const std::vector<torch::Tensor>& teacher_values) const;

  const Network& student_;
  const Network& teacher_;
  std::vector<int> layers_;
};

// Distance of what a student's layers give to what its teacher's give for the same pictures, end to
// end: squared error over the teacher's variance per channel, mean over the layers at an eighth of
// the picture's size and smaller that are as wide in both. `pictures`: the indices in the batch
// that count.
torch::Tensor FeatureDistance(const ModelGraph& student,
                              const std::vector<torch::Tensor>& student_values,
                              const ModelGraph& teacher,
                              const std::vector<torch::Tensor>& teacher_values,
                              const torch::Tensor& pictures);

// Replaces the class logits among a network's `values` for some pictures by the mean of these and
// of what it gives for the mirror images: errs less than either (see detection/mirror_average.h).
void AverageClassesWithMirror(const Network& network, std::vector<torch::Tensor>& values);

// Distance of a student's class logits to its teacher's: squared error over variance, weighted by
// the teacher's scores, mean over the scales. Keeps what the teacher knows of classes that the
// training images hardly show. `angles` ([batch], radians): by how much the student's pictures were
// rotated from those the teacher was shown; its logits are turned alike, and cells whose
// counterpart it did not see do not count.
torch::Tensor ClassDistance(const HeadOutputs& student, const HeadOutputs& teacher,
                            const torch::Tensor& angles);

}  // namespace msf

#pragma once

namespace perch {

/// The share of Polyak's step that a subgradient method takes: halved where the bound stands still.
class Relaxation {
 public:
  void note(bool gained) {
    if (gained) {
      without_gain_ = 0;
    } else if (++without_gain_ == patience) {
      without_gain_ = 0;
      share_ *= 0.5;
    }
  }
  double share() const { return share_; }
  /// True once the steps have become small.
  bool spent() const { return share_ < least; }

 private:
  static constexpr int patience = 4;  // iterations without a better bound
  static constexpr double least = 0.02;

  double share_ = 1.0;
  int without_gain_ = 0;
};

}  // namespace perch

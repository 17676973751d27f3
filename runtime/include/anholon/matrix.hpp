// SPDX-License-Identifier: MIT
#pragma once

// A dense row-major matrix over any scalar, for sizes known at run time.

#include <cstddef>
#include <vector>

namespace anholon {

template <class S>
class Matrix {
 public:
  Matrix() = default;
  Matrix(int rows, int cols)
      : rows_(rows),
        cols_(cols),
        entries_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols), S(0)) {}

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int cols() const { return cols_; }
  S& operator()(int i, int j) { return entries_[index(i, j)]; }
  const S& operator()(int i, int j) const { return entries_[index(i, j)]; }
  [[nodiscard]] const std::vector<S>& entries() const { return entries_; }

  [[nodiscard]] Matrix transposed() const {
    Matrix r(cols_, rows_);
    for (int i = 0; i < rows_; ++i) {
      for (int j = 0; j < cols_; ++j) r(j, i) = (*this)(i, j);
    }
    return r;
  }
  /// The rows and columns with the given indices, in their order.
  [[nodiscard]] Matrix block(const std::vector<int>& rows, const std::vector<int>& cols) const {
    Matrix r(static_cast<int>(rows.size()), static_cast<int>(cols.size()));
    for (int i = 0; i < r.rows_; ++i) {
      for (int j = 0; j < r.cols_; ++j)
        r(i, j) = (*this)(rows[static_cast<std::size_t>(i)], cols[static_cast<std::size_t>(j)]);
    }
    return r;
  }
  friend Matrix operator*(const Matrix& a, const Matrix& b) {
    Matrix r(a.rows_, b.cols_);
    for (int i = 0; i < a.rows_; ++i) {
      for (int j = 0; j < b.cols_; ++j) {
        S sum = S(0);
        for (int k = 0; k < a.cols_; ++k) sum = sum + a(i, k) * b(k, j);
        r(i, j) = sum;
      }
    }
    return r;
  }
  friend Matrix operator+(const Matrix& a, const Matrix& b) {
    Matrix r = a;
    for (std::size_t i = 0; i < r.entries_.size(); ++i) r.entries_[i] = a.entries_[i] + b.entries_[i];
    return r;
  }
  friend Matrix operator-(const Matrix& a, const Matrix& b) {
    Matrix r = a;
    for (std::size_t i = 0; i < r.entries_.size(); ++i) r.entries_[i] = a.entries_[i] - b.entries_[i];
    return r;
  }

 private:
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(j);
  }
  int rows_ = 0;
  int cols_ = 0;
  std::vector<S> entries_;
};

template <class S>
std::vector<S> operator*(const Matrix<S>& a, const std::vector<S>& x) {
  std::vector<S> y(static_cast<std::size_t>(a.rows()), S(0));
  for (int i = 0; i < a.rows(); ++i) {
    for (int j = 0; j < a.cols(); ++j)
      y[static_cast<std::size_t>(i)] =
          y[static_cast<std::size_t>(i)] + a(i, j) * x[static_cast<std::size_t>(j)];
  }
  return y;
}

}  // namespace anholon

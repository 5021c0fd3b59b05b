#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/scenario/set_distance.hpp>
#include <limits>

namespace isobath {

std::vector<std::size_t> least_assignment(const Eigen::MatrixXd& cost) {
  const auto rows = static_cast<std::size_t>(cost.rows()), columns = static_cast<std::size_t>(cost.cols());
  ISOBATH_ASSERT(rows <= columns);
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  const auto at = [&](std::size_t row, std::size_t column) {
    return cost(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
  };
  // Potentials of rows and columns; the last column is where each row begins.
  std::vector<double> row_price(rows, 0), column_price(columns + 1, 0);
  std::vector<std::size_t> row_of(columns + 1, kNone);
  for (std::size_t row = 0; row < rows; ++row) {
    std::vector<double> least(columns, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> from(columns, columns);
    std::vector<bool> used(columns + 1, false);
    std::size_t column = columns;
    row_of[column] = row;
    while (row_of[column] != kNone) {
      used[column] = true;
      std::size_t next = columns;
      double step = std::numeric_limits<double>::infinity();
      for (std::size_t j = 0; j < columns; ++j) {
        if (used[j]) continue;
        const double reduced = at(row_of[column], j) - row_price[row_of[column]] - column_price[j];
        if (reduced < least[j]) {
          least[j] = reduced;
          from[j] = column;
        }
        if (least[j] < step) {
          step = least[j];
          next = j;
        }
      }
      for (std::size_t j = 0; j <= columns; ++j) {
        if (used[j]) {
          row_price[row_of[j]] += step;
          column_price[j] -= step;
        } else if (j < columns) {
          least[j] -= step;
        }
      }
      column = next;
    }
    while (column != columns) {
      row_of[column] = row_of[from[column]];
      column = from[column];
    }
  }
  std::vector<std::size_t> column_of(rows, 0);
  for (std::size_t j = 0; j < columns; ++j) {
    if (row_of[j] != kNone) column_of[row_of[j]] = j;
  }
  return column_of;
}

SetDistance set_distance(std::span<const Eigen::Vector2d> a, std::span<const Eigen::Vector2d> b, double cut_off_m) {
  SetDistance distance;
  if (a.empty() && b.empty()) return distance;
  const bool a_is_fewer = a.size() <= b.size();
  const auto& few = a_is_fewer ? a : b;
  const auto& many = a_is_fewer ? b : a;
  Eigen::MatrixXd cost(static_cast<Eigen::Index>(few.size()), static_cast<Eigen::Index>(many.size()));
  for (std::size_t i = 0; i < few.size(); ++i) {
    for (std::size_t j = 0; j < many.size(); ++j) {
      cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = std::min(cut_off_m, (few[i] - many[j]).norm());
    }
  }
  const std::vector<std::size_t> assigned = least_assignment(cost);
  double sum = cut_off_m * static_cast<double>(many.size() - few.size());
  for (std::size_t i = 0; i < few.size(); ++i) {
    const std::size_t j = assigned[i];
    const double apart_m = (few[i] - many[j]).norm();
    sum += std::min(cut_off_m, apart_m);
    if (apart_m < cut_off_m) distance.pairs.emplace_back(a_is_fewer ? i : j, a_is_fewer ? j : i);
  }
  distance.ospa_m = sum / static_cast<double>(many.size());
  return distance;
}

}  // namespace isobath

#pragma once

#include <string>

#include "ferrers/io/json_values.h"
#include "ferrers/kinematics/system.h"

/// Vectors, matrices and texts as JSON values, for the writers of reports. Internal to io.
namespace ferrers {

inline OrderedJson vector_value(const VectorXd& values) {
  OrderedJson out = OrderedJson::array();
  for (const double value : values) out.push_back(value);
  return out;
}

/// A list of rows.
inline OrderedJson matrix_value(const MatrixXd& M) {
  OrderedJson out = OrderedJson::array();
  for (long i = 0; i < M.rows(); ++i) out.push_back(vector_value(M.row(i).transpose()));
  return out;
}

inline OrderedJson text_or_null(const std::string& text) { return text.empty() ? OrderedJson() : OrderedJson(text); }

}  // namespace ferrers

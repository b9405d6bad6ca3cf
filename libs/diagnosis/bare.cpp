#include "diagnosis/bare.h"

#include "effects/catalogue.h"

namespace fathom {
namespace {

Eigen::VectorXd valuesOf(const Linearization& linear, const std::vector<Candidate>& effects,
                         const BatchState& state) {
  std::vector<double> values;
  for (const Candidate& effect : effects)
    for (const CandidateColumn& c : columnsOf(linear, effect.effect)) {
      const std::size_t scalar = linear.columns[c.column].scalar;
      values.push_back(c.image < 0 ? sizeOf(scalar, state.effects.values[scalar])
                                   : state.drawn({scalar, static_cast<std::size_t>(c.image)}));
    }
  return Eigen::Map<Eigen::VectorXd>(values.data(), std::ssize(values));
}

bool isOfEffect(const Linearization& linear, const UnknownBlock& block) {
  return block.kind == UnknownBlock::Kind::effect ||
         (block.kind == UnknownBlock::Kind::draw &&
          isEstimated(linear, effectOf(linear.draws[block.index].scalar)));
}

/// What holds an effect's unknowns alone says nothing where they are none.
void clearEmptyPriors(Linearization& bare) {
  std::vector<bool> is_empty(bare.rows.size(), true);
  for (Eigen::Index c = 0; c < bare.J.outerSize(); ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator e(bare.J, c); e; ++e)
      is_empty[static_cast<std::size_t>(e.row())] = false;
  for (std::size_t i = 0; i < bare.rows.size(); ++i)
    if (bare.rows[i].channel == kChannel<Prior> && is_empty[i])
      bare.residual[static_cast<Eigen::Index>(i)] = 0;
}

}  // namespace

Bare withoutEffects(const Linearization& linear, const std::vector<Candidate>& effects,
                    const BatchState& state) {
  Bare bare{linear, columnsOf(linear, effects), valuesOf(linear, effects, state)};
  bare.linear.residual -= bare.columns * bare.values;
  std::vector<Eigen::Triplet<double>> entries;
  int width = 0;
  bare.linear.blocks.clear();
  for (UnknownBlock block : linear.blocks) {
    if (isOfEffect(linear, block)) continue;
    for (int k = 0; k < block.size; ++k)
      for (Eigen::SparseMatrix<double>::InnerIterator e(linear.J, block.column + k); e; ++e)
        entries.emplace_back(static_cast<int>(e.row()), width + k, e.value());
    block.column = width;
    width += block.size;
    bare.linear.blocks.push_back(block);
  }
  bare.linear.J.resize(linear.J.rows(), width);
  bare.linear.J.setFromTriplets(entries.begin(), entries.end());
  for (EffectColumn& column : bare.linear.columns) column.estimated = false;
  clearEmptyPriors(bare.linear);
  return bare;
}

}  // namespace fathom

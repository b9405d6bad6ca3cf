#include "diagnosis/bare.h"

#include <utility>

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
void clearEmptyPriors(const Linearization& linear, Bare& bare) {
  std::vector<bool> is_empty(linear.rows.size(), true);
  for (Eigen::Index c = 0; c < bare.J.outerSize(); ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator e(bare.J, c); e; ++e)
      is_empty[static_cast<std::size_t>(e.row())] = false;
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    if (linear.rows[i].channel == kChannel<Prior> && is_empty[i])
      bare.residual[static_cast<Eigen::Index>(i)] = 0;
}

}  // namespace

Bare bareOf(const Linearization& linear, const std::vector<Candidate>& effects, const BatchState& state) {
  Bare bare;
  bare.columns = columnsOf(linear, effects);
  bare.values = valuesOf(linear, effects, state);
  bare.residual = linear.residual - bare.columns * bare.values;
  Eigen::Index width = 0;
  for (UnknownBlock block : linear.blocks)
    if (!isOfEffect(linear, block)) width += block.size;
  bare.J.resize(linear.J.rows(), width);
  bare.J.reserve(linear.J.nonZeros());
  width = 0;
  for (UnknownBlock block : linear.blocks) {
    if (isOfEffect(linear, block)) continue;
    for (int k = 0; k < block.size; ++k) {
      bare.J.startVec(width + k);
      for (Eigen::SparseMatrix<double>::InnerIterator e(linear.J, block.column + k); e; ++e)
        bare.J.insertBack(e.row(), width + k) = e.value();
    }
    block.column = static_cast<decltype(block.column)>(width);
    width += block.size;
    bare.blocks.push_back(block);
  }
  bare.J.finalize();
  clearEmptyPriors(linear, bare);
  return bare;
}

Linearization withoutEffects(Linearization linear, Bare bare) {
  linear.residual = std::move(bare.residual);
  linear.J.swap(bare.J);  // this Eigen moves no sparse matrix
  linear.blocks = std::move(bare.blocks);
  for (EffectColumn& column : linear.columns) column.estimated = false;
  return linear;
}

}  // namespace fathom

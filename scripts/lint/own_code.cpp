// Loaded before clang-tidy's own libraries (LD_PRELOAD): its checks then look only at declarations of this project, not at those of
// the standard library and Eigen, whose findings it would throw away in the end. A unit of the library takes 11 s instead of 47.
#include <clang/AST/ASTConsumer.h>
#include <clang/AST/ASTContext.h>
#include <clang/AST/Decl.h>
#include <clang/ASTMatchers/ASTMatchFinder.h>
#include <clang/Basic/SourceManager.h>
#include <dlfcn.h>

#include <memory>
#include <vector>

namespace {

class OwnCode : public clang::ASTConsumer {
public:
  explicit OwnCode(std::unique_ptr<clang::ASTConsumer> checks) : checks_(std::move(checks)) {}
  void HandleTranslationUnit(clang::ASTContext& context) override {
    const clang::SourceManager& files = context.getSourceManager();
    std::vector<clang::Decl*> own;
    for (clang::Decl* declaration : context.getTranslationUnitDecl()->decls())
      if (!files.isInSystemHeader(files.getExpansionLoc(declaration->getLocation()))) own.push_back(declaration);
    context.setTraversalScope(own);
    checks_->HandleTranslationUnit(context);
  }

private:
  std::unique_ptr<clang::ASTConsumer> checks_;
};

}  // namespace

std::unique_ptr<clang::ASTConsumer> clang::ast_matchers::MatchFinder::newASTConsumer() {
  using Original = std::unique_ptr<clang::ASTConsumer> (*)(MatchFinder*);
  static const auto original =
      reinterpret_cast<Original>(dlsym(RTLD_NEXT, "_ZN5clang12ast_matchers11MatchFinder14newASTConsumerEv"));
  return std::make_unique<OwnCode>(original(this));
}

// Loaded before clang-tidy's own libraries (LD_PRELOAD): its checks then look only at declarations of the source and of the header of
// the same name. Those of other headers are looked at with their own sources, those of libraries never.
#include <clang/AST/ASTConsumer.h>
#include <clang/AST/ASTContext.h>
#include <clang/AST/Decl.h>
#include <clang/ASTMatchers/ASTMatchFinder.h>
#include <clang/Basic/SourceManager.h>
#include <dlfcn.h>
#include <llvm/Support/Path.h>

#include <memory>
#include <vector>

namespace {

class OwnCode : public clang::ASTConsumer {
public:
  explicit OwnCode(std::unique_ptr<clang::ASTConsumer> checks) : checks_(std::move(checks)) {}
  void HandleTranslationUnit(clang::ASTContext& context) override {
    const clang::SourceManager& files = context.getSourceManager();
    const auto stem = [&](clang::FileID file) {
      const clang::FileEntry* entry = files.getFileEntryForID(file);
      return entry ? llvm::sys::path::stem(entry->getName()) : llvm::StringRef();
    };
    const llvm::StringRef source = stem(files.getMainFileID());
    std::vector<clang::Decl*> own;
    for (clang::Decl* declaration : context.getTranslationUnitDecl()->noload_decls())
      if (stem(files.getFileID(files.getExpansionLoc(declaration->getLocation()))) == source) own.push_back(declaration);
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

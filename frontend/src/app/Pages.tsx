import { lazy, Suspense, type ReactNode } from "react";
import { Center, Loader } from "@mantine/core";
import { Redirect, Route, Switch, useLocation } from "wouter";
import { useAccount } from "../account/Account";
import { LinkPage } from "../account/LinkPage";
import { SignInPage } from "../account/SignInPage";
import { PatientListPage } from "../patients/PatientListPage";
import { PatientPage } from "../patients/PatientPage";
import { Shell } from "./Shell";

const VisitPage = lazy(() => import("../visit/VisitPage"));
const ResultPage = lazy(() => import("../result/ResultPage"));
const ComparePage = lazy(() => import("../compare/ComparePage"));
const JobsPage = lazy(() => import("../jobs/JobsPage"));
const AccountPage = lazy(() => import("../account/AccountPage"));
const AdminPage = lazy(() => import("../admin/AdminPage"));

function Waiting() {
  return (
    <Center p="xl">
      <Loader />
    </Center>
  );
}

function SignedInOnly({ children }: { children: ReactNode }) {
  const { session, loading } = useAccount();
  if (loading) return <Waiting />;
  return session ? <Shell>{children}</Shell> : <SignInPage />;
}

export function Pages() {
  const [location] = useLocation();
  if (location === "/link") return <LinkPage />;
  return (
    <SignedInOnly>
      <Suspense fallback={<Waiting />}>
        <Switch>
          <Route path="/patients" component={PatientListPage} />
          <Route path="/patients/:id">{({ id }) => <PatientPage key={id} id={id} />}</Route>
          <Route path="/visits/:id">{({ id }) => <VisitPage key={id} id={id} />}</Route>
          <Route path="/results/:id">{({ id }) => <ResultPage key={id} id={id} />}</Route>
          <Route path="/compare" component={ComparePage} />
          <Route path="/jobs" component={JobsPage} />
          <Route path="/account" component={AccountPage} />
          <Route path="/admin" component={AdminPage} />
          <Route>
            <Redirect to="/patients" replace />
          </Route>
        </Switch>
      </Suspense>
    </SignedInOnly>
  );
}
